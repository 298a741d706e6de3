// Two nets side by side: which, their nets and figures as the engine tells them, and the scale that they share.
import { createStore } from "zustand/vanilla";
import { comparedInAddress, documentInAddress, putComparedInAddress } from "../protocol/address";
import { fetchCompared } from "../protocol/fetching";
import type { Compared } from "../protocol/messages";
import type { ColourChoice } from "./colouring";
import { type Pictured, pictureAt } from "./pictured";
import { pathOfSide, pinOfSide, type Side, shownSide } from "./pins";
import { type Quantity, quantityOf } from "./quantities";
import { scaleOf } from "./scale";
import { NOTHING } from "./selection";
import { notify, select, store } from "./store";

export interface Comparison {
  /** The net at the left and the one at the right; null: nothing is compared. */
  sides: [Side, Side] | null;
  /** Name of the run that individuals are of. */
  run: string;
  /** What was fetched of them; null until it is there. */
  nets: [Pictured | null, Pictured | null];
  table: Compared | null;
}

const NONE: Comparison = { sides: null, run: "", nets: [null, null], table: null };

export const comparing = createStore<Comparison>()(() => NONE);

export function isComparing(): boolean {
  return comparing.getState().sides !== null;
}

/** Shows two nets side by side. */
export function compare(first: Side, second: Side): void {
  if (first === second) {
    notify("these are the same net; choose another one to compare it with");
    return;
  }
  select(NOTHING);
  store.setState({ tool: "pull", hover: null, marked: [] });
  take([first, second]);
}

export function stopComparing(): void {
  comparing.setState(NONE);
}

/** Left becomes right. */
export function swapSides(): void {
  const { sides, nets, table } = comparing.getState();
  if (!sides) return;
  comparing.setState({
    sides: [sides[1], sides[0]],
    nets: [nets[1], nets[0]],
    table: table && {
      ...table,
      first: table.second,
      second: table.first,
      types: table.types.map(({ name, first, second }) => ({ name, first: second, second: first })),
      reactions: table.reactions.map(({ anchor, first, second }) => ({
        anchor,
        first: second,
        second: first,
      })),
    },
  });
}

/** Puts another net at the left (0) or at the right (1); the one of the other side changes places with it. */
export function setSide(at: 0 | 1, side: Side): void {
  const { sides } = comparing.getState();
  if (!sides || sides[at] === side) return;
  if (sides[1 - at] === side) swapSides();
  else take(at ? [sides[0], side] : [side, sides[1]]);
}

/** What somebody most likely wants to compare; null if there is only one net to see. */
export function likelySides(): [Side, Side] | null {
  const { marked, pins, document } = store.getState();
  if (marked.length === 2) return [marked[0], marked[1]];
  const shown = shownSide(document);
  const other = marked.find((side) => side !== shown);
  if (other) return [shown, other];
  if (shown !== "design") return ["design", shown];
  const last = pins.at(-1);
  return last ? ["design", `pin/${last.number}`] : null;
}

let takes = 0;

async function take(sides: [Side, Side]): Promise<void> {
  const before = comparing.getState();
  const one = ++takes;
  const id = documentInAddress();
  // What is there stays until what comes in its place has come.
  const kept = (at: 0 | 1) => (before.sides?.[at] === sides[at] ? before.nets[at] : null);
  const run = store.getState().run?.state.name ?? "";
  comparing.setState({ sides, run, nets: [kept(0), kept(1)], table: null });
  try {
    const [first, second, table] = await Promise.all([
      pictureAt(pathOfSide(id, sides[0])),
      pictureAt(pathOfSide(id, sides[1])),
      fetchCompared(id, { first: sides[0], second: sides[1] }),
    ]);
    if (one !== takes || !isComparing()) return;
    const swapped = comparing.getState().sides![0] !== sides[0];
    comparing.setState({ nets: [first, second], table });
    // Somebody was quicker.
    if (swapped) {
      comparing.setState({ sides });
      swapSides();
    }
  } catch (error) {
    if (one !== takes) return;
    notify((error as Error).message);
    stopComparing();
  }
}

/** Compares what the address says; individuals only of the run that it names, which is another one after a restart. */
export function compareAsInAddress(): void {
  const said = comparedInAddress();
  const { run } = store.getState();
  if (!said) {
    stopComparing();
    return;
  }
  const individuals = said.sides.some((side) => side.startsWith("run/"));
  if (individuals && said.run !== run?.state.name) {
    putComparedInAddress(null);
    notify("the individuals that were compared are of another run; show it first");
    return;
  }
  const now = comparing.getState().sides;
  if (`${now}` !== `${said.sides}`) compare(...said.sides);
}

comparing.subscribe(({ sides, run }, before) => {
  // While a document is opened, the address says what is to be compared in it.
  if (sides !== before.sides && store.getState().document)
    putComparedInAddress(sides && { sides, run });
});

store.subscribe(({ run }, before) => {
  // By then the document is known; what is pinned comes at once.
  if (run && !before.run) compareAsInAddress();
});

store.subscribe(({ document }, before) => {
  const { sides } = comparing.getState();
  if (!sides) return;
  if (document?.document !== before.document?.document) stopComparing();
  else if (sides.includes("design") && document?.position !== before.document?.position)
    void take(sides);
});

/** The quantity that both nets are coloured by: as chosen, or by force if that is no number. */
export function sharedQuantity(choice: ColourChoice): Quantity {
  return quantityOf(choice.by) ?? quantityOf("force")!;
}

/** The choice of colours with one scale for both nets: over the values of both. */
export function sharedColour(nets: Comparison["nets"], choice: ColourChoice): ColourChoice {
  const quantity = sharedQuantity(choice);
  const all = nets.map((one) => (one ? quantity.values(one.net, one.motion) : new Float32Array()));
  const values = new Float32Array(all[0].length + all[1].length);
  values.set(all[0]);
  values.set(all[1], all[0].length);
  const { low, high } = scaleOf(values, choice);
  return { ...choice, by: quantity.id, mode: "fixed", fixed: [low, high] };
}

/** Compares a net with what is shown, or with the design if that is the same net. */
export function compareWith(side: Side): void {
  const state = store.getState();
  const shown = shownSide(state.document);
  const pin = pinOfSide(state, side);
  const same = shown === side || (pin !== null && pinOfSide(state, shown) === pin);
  compare(same && shown !== "design" ? "design" : shown, side);
}
