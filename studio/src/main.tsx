// The studio begins here.
import "@fontsource-variable/inter";
import { createRoot } from "react-dom/client";
import { App } from "./panels/App";
import "./panels/theme.css";
import "./panels/layout.css";
import "./panels/parts.css";
import "./panels/reading.css";
import "./panels/lists.css";
import "./panels/overlays.css";
import "./panels/editing.css";
import "./panels/start.css";
import "./panels/evolve.css";
import "./panels/framework.css";
import "./panels/choose.css";

createRoot(document.getElementById("root")!).render(<App />);
