// Nets by what the engine calls them (`design`, `pin/4`, `run/34/2`), and which of them are pinned.
import type { Comparing, DocumentState, PinState } from "../protocol/messages";
import { type Individuals, placeOf, type Run } from "./run";
import { ask, type State, store } from "./store";
import { inTurn } from "./turns";

/** A net that can be looked at, pinned and compared. */
export type Side = Comparing["first"];

type Place = NonNullable<PinState["place"]>;
type Known = Pick<State, "document" | "pins" | "run">;

/** An individual of the run, or the parent of a generation. */
export function sideOf(generation: number, individual: number | null): Side {
  return individual === null ? `run/${generation}` : `run/${generation}/${individual}`;
}

export function sideOfRow(individuals: Individuals, row: number): Side {
  const { generation, individual } = placeOf(individuals, row);
  return sideOf(generation, individual);
}

/** What is shown now. */
export function shownSide(document: DocumentState | null): Side {
  const looking = document?.looking;
  if (!looking) return "design";
  return looking.generation === null
    ? `pin/${looking.pin}`
    : sideOf(looking.generation, looking.individual);
}

/** Where a net comes from; null for a design with actions of its own. */
export function placeOfSide({ document, pins, run }: Known, side: Side): Place | null {
  const [kind, first, second] = side.split("/");
  if (kind === "pin") return pins.find(({ number }) => number === Number(first))?.place ?? null;
  if (kind === "run") {
    const name = run?.state.name ?? "";
    if (second !== undefined)
      return { run: name, generation: Number(first), individual: Number(second) };
    return parentOf(run, name, Number(first));
  }
  const done = document?.history.find(({ number }) => number === document.position);
  return done?.origin ?? null;
}

/** The parent of a generation is an individual, maybe of an earlier one. */
function parentOf(run: Run | null, name: string, generation: number): Place {
  for (const row of run?.rows.slice(0, generation).reverse() ?? [])
    if (row.winner !== null)
      return { run: name, generation: row.generation, individual: row.winner };
  return { run: name, generation: 0, individual: null };
}

/** The pin of a net, if it is pinned. */
export function pinOfSide(state: Known, side: Side): PinState | null {
  const [kind, number] = side.split("/");
  if (kind === "pin") return state.pins.find((pin) => pin.number === Number(number)) ?? null;
  const place = placeOfSide(state, side);
  return place ? (state.pins.find((pin) => same(pin.place, place)) ?? null) : null;
}

function same(one: Place | null, other: Place): boolean {
  return (
    one !== null &&
    one.run === other.run &&
    one.generation === other.generation &&
    one.individual === other.individual
  );
}

/** Rows of the run's individuals that are pinned. */
export function pinnedRows({ population }: Individuals, pins: PinState[], name: string): number[] {
  return pins.flatMap(({ place }) =>
    place && place.run === name && place.individual !== null && place.generation > 0
      ? [(place.generation - 1) * population + place.individual]
      : [],
  );
}

/** What a net is called. */
export function labelOfSide(pins: PinState[], side: Side): string {
  const [kind, first, second] = side.split("/");
  if (kind === "design") return "My design";
  if (kind === "pin")
    return pins.find(({ number }) => number === Number(first))?.label ?? `Pin ${first}`;
  return second === undefined
    ? `Generation ${first}, its parent`
    : `Generation ${first}, individual ${second}`;
}

/** Pins a net, or lets it go. */
export function togglePin(side: Side): void {
  inTurn(() => {
    const pin = pinOfSide(store.getState(), side);
    if (pin) ask({ type: "unpin", pin: pin.number }, "Letting go");
    else if (!side.startsWith("pin/")) ask({ type: "pin", side }, "Pinning");
  });
}

/** Calls a pin something else. */
export function renamePin(pin: PinState, label: string): void {
  if (label !== pin.label) ask({ type: "rename_pin", pin: pin.number, label }, "Renaming");
}

/** Shows a net. */
export function lookAt(side: Side): void {
  const [kind, first, second] = side.split("/");
  const label = "Rebuilding the net";
  if (kind === "pin")
    ask({ type: "look", generation: null, individual: null, pin: Number(first) }, label);
  else if (kind === "run")
    ask(
      {
        type: "look",
        generation: Number(first),
        individual: second === undefined ? null : Number(second),
        pin: null,
      },
      label,
    );
  else ask({ type: "look", generation: null, individual: null, pin: null }, label);
}

/** Marks a net for a comparison, or takes the mark away; the last two count. */
export function toggleMark(side: Side): void {
  store.setState(({ marked }) => ({
    marked: marked.includes(side)
      ? marked.filter((one) => one !== side)
      : [...marked, side].slice(-2),
  }));
}

/** Address of a net's picture. */
export function pathOfSide(document: string, side: Side): string {
  return `/api/documents/${document}/net/${side}`;
}
