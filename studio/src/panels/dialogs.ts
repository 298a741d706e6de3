// What opens over the page, for components.
import { createContext, useContext } from "react";
import type { Dialogs } from "./commands";

export const DialogsContext = createContext<Dialogs>({ open: () => {} });

export function useDialogs(): Dialogs {
  return useContext(DialogsContext);
}
