// Patches, the ghost of the one in the hand, and the symmetry lock: what a window knows of grafting.
import { createStore } from "zustand/vanilla";
import type { GraftPlan, Patches, SymmetryState } from "../protocol/messages";

/** Where a patch is to be set. */
export type Place = "one" | "orbit" | "anchors";

export interface Grafting {
  patches: Patches | null;
  /** Name of the patch in the hand. */
  chosen: string | null;
  place: Place;
  /** What the pointer is over, or what it was clicked on. */
  target: { cell: number | null; anchor: string | null } | null;
  /** Whether the target was clicked, and no longer follows the pointer. */
  pinned: boolean;
  rotate: number;
  mirror: boolean;
  plan: GraftPlan | null;
  /** Why it does not fit there. */
  problem: string;
  /** Whether edits of cells and springs are done to their whole orbit. */
  lock: boolean;
  symmetry: SymmetryState | null;
  /** Outline of a box or a lasso that is being drawn, on the canvas [px]. */
  outline: [number, number][];
}

const EMPTY = {
  chosen: null,
  target: null,
  pinned: false,
  rotate: 0,
  mirror: false,
  plan: null,
  problem: "",
};

export const grafting = createStore<Grafting>()(() => ({
  ...EMPTY,
  patches: null,
  place: "one",
  lock: false,
  symmetry: null,
  outline: [],
}));

/** Puts the patch in the hand away. */
export function putAway(): void {
  grafting.setState(EMPTY);
}
