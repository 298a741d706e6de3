// The store and the viewport for components.
import { createContext, useContext, useEffect, useState } from "react";
import { useStore } from "zustand";
import { type Comparison, comparing } from "../document/comparing";
import { type State, store } from "../document/store";
import type { Hands } from "../tools/hands";
import type { Viewport } from "../viewport/scene";

/** A part of the store; the component is drawn again when it changes. */
export function useStudio<T>(part: (state: State) => T): T {
  return useStore(store, part);
}

/** A part of what is known of two nets side by side. */
export function useComparing<T>(part: (state: Comparison) => T): T {
  return useStore(comparing, part);
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

const EVERY = 100; // ms; numbers need not follow every frame

const seenNow = ({ net, motion } = store.getState()) => ({ net, motion });

/** The net and its motion as they belong together, at most every tenth of a second. */
export function useCalmNet() {
  const [seen, setSeen] = useState(seenNow);
  useEffect(() => {
    let timer = 0;
    const stop = store.subscribe((state, before) => {
      if (state.motion === before.motion || timer) return;
      timer = window.setTimeout(() => {
        timer = 0;
        setSeen(seenNow());
      }, EVERY);
    });
    return () => {
      stop();
      clearTimeout(timer);
    };
  }, []);
  return seen;
}

/** The motion now, at most every tenth of a second. */
export function useCalmMotion() {
  return useCalmNet().motion;
}
