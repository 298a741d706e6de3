// The store and the viewport for components.
import { createContext, useContext } from "react";
import { useStore } from "zustand";
import { type State, store } from "../document/store";
import type { Hands } from "../tools/hands";
import type { Viewport } from "../viewport/scene";

/** A part of the store; the component is drawn again when it changes. */
export function useStudio<T>(part: (state: State) => T): T {
  return useStore(store, part);
}

/** What draws the net, and what drives it; null until the canvas is there. */
export interface Stage {
  viewport: Viewport;
  hands: Hands;
}

export const StageContext = createContext<Stage | null>(null);

export function useStage(): Stage | null {
  return useContext(StageContext);
}
