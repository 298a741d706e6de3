// What is asked of the engine for selections and grafts; problems of a plan are shown where it is.
import type { GraftPlan, SymmetryState } from "../protocol/messages";
import { type Grafting, grafting, type Place, putAway } from "./grafting";
import { shownSide } from "./pins";
import { NOTHING } from "./selection";
import { ask, askQuietly, select, selecting, store } from "./store";

/** Selects what words say, or a selection grown by some rings; not if something else was selected meanwhile. */
export async function selectBy(
  request:
    | { words: string }
    | { around_best: number }
    | { cells: string[]; grow: number }
    | { cells: string[]; orbit: true },
  adding: boolean,
): Promise<void> {
  const { selection } = store.getState();
  const before = adding && selection.kind === "cells" ? selection.keys : [];
  const answer = selecting();
  const nothing = { words: null, around_best: null, cells: [], grow: 0, orbit: false };
  await ask({ type: "select_cells", ...nothing, ...request }, "Selecting", ({ cells }) =>
    answer({ kind: "cells", keys: [...new Set([...before, ...cells])] }),
  );
}

/** Top-level cell of an address. */
export function topLevel(address: string): number {
  return Number(address.split(".")[0]);
}

/** Words that select the cells whose springs carry together about as much as those of a cell [N]. */
export function bandOf(row: number): string {
  const { net, motion } = store.getState();
  if (!net || !motion) return "all";
  const { starts, items } = net.own;
  let sum = 0;
  for (const spring of items.subarray(starts[row], starts[row + 1])) sum += motion.forces[spring];
  return `force(${(0.9 * sum).toFixed(9)}..${(1.1 * sum).toFixed(9)})`;
}

/** Selects what is not selected. */
export function invertSelection(): void {
  const { net, selection } = store.getState();
  if (!net) return;
  const chosen = new Set(selection.kind === "cells" ? selection.keys : []);
  select({ kind: "cells", keys: net.addresses.filter((address) => !chosen.has(address)) });
}

export function selectAll(): void {
  const { net } = store.getState();
  select(net ? { kind: "cells", keys: [...net.addresses] } : NOTHING);
}

/** Selects the two rings of cells round the anchor that is resolved best. */
export function selectBestAnchor(): void {
  selectBy({ around_best: 2 }, false);
}

/** Anchors at the corners of the selected cells. */
export function anchorsAtSelection(): string[] {
  const { net, selection } = store.getState();
  if (!net || selection.kind !== "cells") return [];
  const chosen = new Set(selection.keys);
  const nodes = new Set<number>();
  net.addresses.forEach((address, cell) => {
    if (!chosen.has(address)) return;
    const { starts, items } = net.boundaries;
    for (const node of items.subarray(starts[cell], starts[cell + 1])) nodes.add(node);
  });
  return net.anchorNames.filter((_, anchor) => nodes.has(net.anchors[anchor]));
}

/** What a patch can be seen from: an anchor, its seed cell, or any cell. */
export interface SeenFrom {
  value: string;
  name: string;
  explains: string;
  anchor: string | null;
  seed: number | null;
}

/** What the selected cells can be seen from as a patch, the likeliest first. */
export function placesSeenFrom(): [SeenFrom, ...SeenFrom[]] {
  const { selection } = store.getState();
  const anchors = anchorsAtSelection().map((anchor) => {
    const name = `anchor ${anchor}`;
    const explains = "it is set round other anchors as it lies round this one";
    return { value: name, name, explains, anchor, seed: null };
  });
  const last = selection.kind === "cells" ? selection.keys.at(-1) : undefined;
  const any = {
    value: "free",
    name: "any cell",
    explains: "it is set on any cell that it fits",
    anchor: null,
    seed: null,
  };
  const seed = last === undefined ? null : topLevel(last);
  const [first = any, ...others] = anchors.length ? [...anchors, any] : [any];
  if (seed === null) return [first, ...others];
  return [
    first,
    ...others,
    {
      value: "seed",
      name: `cell ${seed}, chosen last`,
      explains: "this cell comes to lie on the one that is clicked",
      anchor: null,
      seed,
    },
  ];
}

/** A name that no patch has. */
export function freeName({ patches } = grafting.getState()): string {
  const taken = new Set(patches?.patches.map(({ name }) => name));
  let number = 1;
  while (taken.has(`patch_${number}`)) number++;
  return `patch_${number}`;
}

/** Keeps the selected cells as a patch; resolves to whether it did. */
export async function copyPatch(name: string, { anchor, seed }: SeenFrom): Promise<boolean> {
  const { document, selection } = store.getState();
  const [cells, side] = [selection.keys, shownSide(document)];
  const request = { type: "copy_patch", name, cells, anchor, seed, side } as const;
  return !!(await ask(request, "Copying the patch"));
}

export function listPatches(): void {
  ask({ type: "list_patches" }, "Reading patches");
}

/** Reads which symmetries there are. */
export async function readSymmetry(): Promise<void> {
  try {
    const { answer } = await askQuietly({ type: "ask_symmetry" }, "Looking for symmetries");
    grafting.setState({ symmetry: answer as SymmetryState });
  } catch {
    grafting.setState({ symmetry: null });
  }
}

/** Takes a patch into the hand. */
export function takePatch(name: string): void {
  grafting.setState({ chosen: name, plan: null, problem: "" });
  store.setState({ tool: "graft" });
  plan();
}

export function changePlace(place: Place): void {
  grafting.setState({ place, target: null, pinned: false, plan: null, problem: "" });
  plan();
}

/** Turns the ghost one step, or mirrors it. */
export function turnGhost(change: { rotate?: number; mirror?: boolean }): void {
  const { rotate, mirror } = grafting.getState();
  grafting.setState({
    rotate: rotate + (change.rotate ?? 0),
    mirror: change.mirror ? !mirror : mirror,
  });
  plan();
}

function placing() {
  const { chosen, place, target, rotate, mirror, lock } = grafting.getState();
  if (!chosen || (place !== "anchors" && !target)) return null;
  const here = place === "anchors" ? { cell: null, anchor: null } : target!;
  const orbit = place === "orbit" || (place === "one" && lock);
  return { patch: chosen, ...here, rotate, mirror, orbit };
}

let asking = false;
let again = false;

/** Asks where the patch in the hand would come to lie; of many calls the last one counts. */
export async function plan(): Promise<void> {
  if (asking) {
    again = true;
    return;
  }
  const { pinned, place } = grafting.getState();
  const wanted = placing();
  if (!wanted) {
    grafting.setState({ plan: null, problem: "" });
    return;
  }
  asking = true;
  try {
    const { answer } = await askQuietly(
      { type: "plan_graft", measure: pinned || place === "anchors", ...wanted },
      "Placing the patch",
    );
    if (grafting.getState().chosen === wanted.patch)
      grafting.setState({ plan: answer as GraftPlan, problem: "" });
  } catch (error) {
    grafting.setState({ plan: null, problem: (error as Error).message });
  }
  asking = false;
  if (again) {
    again = false;
    plan();
  }
}

/** Whether the patch can be set: what has not been looked at is not. */
export function mayApply(
  { plan: shown, pinned, place }: Pick<Grafting, "plan" | "pinned" | "place"> = grafting.getState(),
): boolean {
  return shown !== null && (place === "anchors" || pinned);
}

/** Sets the patch: one action. */
export async function applyGraft(): Promise<void> {
  const wanted = placing();
  if (!wanted || !mayApply()) return;
  if (await ask({ type: "graft", ...wanted }, "Grafting")) {
    putAway();
    store.setState({ tool: "pull" });
  }
}

// A ghost of another net than the one that is there would mislead.
store.subscribe(({ document, tool, line }, before) => {
  if (tool !== before.tool && tool !== "graft" && grafting.getState().chosen) putAway();
  if (document?.document !== before.document?.document) putAway();
  if (line === "open" && line !== before.line) {
    listPatches();
    readSymmetry();
  }
  if (document && before.document && document.revision !== before.document.revision) {
    readSymmetry();
    if (grafting.getState().chosen) plan();
  }
});
