// The studio begins here.
import "@fontsource-variable/inter";
import { createRoot } from "react-dom/client";
import { store } from "./document/store";
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

/** Puts the page into dark or light, before anything is drawn anew: charts read their colours from it. */
function dress(): void {
  document.documentElement.dataset.theme = store.getState().theme;
}

dress();
store.subscribe(dress);
createRoot(document.getElementById("root")!).render(<App />);
