// What the next run is started with, as it is typed, and why the engine refused it.
import { createStore } from "zustand/vanilla";
import type { Asking, Refused } from "../protocol/connection";
import { MAKING, type ParameterName, type Texts, textOf, valueSaid } from "./parameters";
import { ask, askQuietly, forgetNotice, notify, type State, store } from "./store";

/** What a person may set; the rest has the engine's defaults. */
export const SET = [
  ...MAKING,
  "until_springs",
  "until_differential",
  "generations",
  "seed",
] as const satisfies ParameterName[];

const DEFAULTS: Texts = {
  population: "100",
  insertions: "3",
  switches: "3",
  toggles: "1",
  weighting: "exponential",
  fitness: "suf",
  selection: "comma",
  symmetry: "false",
  until_springs: "2000",
  until_differential: "0",
  generations: "300",
  seed: "1",
};

const TYPES: Record<string, string> = { recursive: "1", extensible: "1,2,3,4,5", dynamic: "1,6" };

/** Those that a run keeps from its start. */
const FIXED: ParameterName[] = ["population", "seed"];

interface Typed {
  /** What was typed; the rest is as the last run had it. */
  texts: Texts;
  /** Why the engine refused it, in its own words. */
  problems: Texts;
  /** Whether the parameters are shown; null: while there is no run. */
  open: boolean | null;
}

const NOTHING_TYPED: Typed = { texts: {}, problems: {}, open: null };

export const starting = createStore<Typed>()(() => NOTHING_TYPED);

/** Every parameter as its field shows it. */
export function textsShown(typed: Texts, { run, document }: State): Texts {
  const kept = run?.state.parameters ?? {};
  const texts: Texts = { ...DEFAULTS, types: TYPES[document?.method ?? ""] ?? "1" };
  for (const name of SET) if (name in kept) texts[name] = textOf(name, kept[name]);
  return { ...texts, ...typed };
}

/** Keeps what was typed into a field. */
export function typeParameter(name: ParameterName, text: string): void {
  starting.setState(({ texts }) => ({ texts: { ...texts, [name]: text } }));
  forgetProblem(name);
}

/** Takes back why a parameter was refused, once it is being mended. */
export function forgetProblem(name: ParameterName): void {
  starting.setState(({ problems }) => ({ problems: { ...problems, [name]: "" } }));
}

async function send(
  label: string,
  names: readonly ParameterName[],
  request: (parameters: Record<string, unknown>) => Asking,
): Promise<boolean> {
  const texts = textsShown(starting.getState().texts, store.getState());
  starting.setState({ problems: {} });
  try {
    const values = names.map((name) => [name, valueSaid(name, texts[name] ?? "")]);
    await askQuietly(request(Object.fromEntries(values)), label);
    forgetNotice();
    return true;
  } catch (error) {
    const { key, words } = error as Refused;
    if (names.includes(key as ParameterName))
      starting.setState({ problems: { [key as string]: words }, open: true });
    else notify((error as Error).message);
    return false;
  }
}

let beginning = false;

/**
 * Starts a run with what is typed, from the design; resolves to whether it began. While one is being started, a second
 * press means the same one.
 */
export async function startRun(): Promise<boolean> {
  if (beginning) return false;
  beginning = true;
  const begun = await send("Starting the run", SET, (parameters) => ({
    type: "evolve",
    side: "design",
    parameters,
  }));
  beginning = false;
  if (begun) starting.setState({ open: false });
  return begun;
}

/** Asks whoever drives the run to pause it, go on with it or end it. */
export function steerRun(what: "pause" | "continue" | "stop"): void {
  ask({ type: "steer_run", what, parameters: {} }, "Steering the run");
}

/** Gives the run that goes on what is typed. */
export function changeRun(): void {
  const names = SET.filter((name) => !FIXED.includes(name));
  send("Changing the parameters", names, (parameters) => ({
    type: "steer_run",
    what: "change",
    parameters,
  }));
}

/** Parameters of a run for another one that goes on from one of its individuals. */
export function changeableOf(parameters: Record<string, unknown>): Record<string, unknown> {
  return Object.fromEntries(
    SET.flatMap((name) => (parameters[name] == null ? [] : [[name, parameters[name]]])),
  );
}

// What was typed was meant for the run, or the design, that was there.
store.subscribe(({ run, document }, before) => {
  if (
    run?.state.folder !== before.run?.state.folder ||
    document?.document !== before.document?.document
  )
    starting.setState(NOTHING_TYPED);
});
