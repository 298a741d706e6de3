// The window's mirror of the session: document, net and motion as the engine tells them, and what is looked at.
import { createStore } from "zustand/vanilla";
import { type Asking, Connection, type Telling } from "../protocol/connection";
import type { Frame } from "../protocol/frames";
import type {
  DocumentState,
  LiveState,
  PinState,
  PreviewState,
  Protocol,
  Reply,
  RunState,
} from "../protocol/messages";
import { onWaits } from "../protocol/waits";
import { type Brushes, SORT, type Sort } from "./choosing";
import type { ColourChoice } from "./colouring";
import { grafting } from "./grafting";
import { type Motion, motionOf } from "./motion";
import { applyNet, type Net } from "./net";
import type { Theme } from "./palettes";
import { type Individuals, moreIndividuals, NO_INDIVIDUALS, type Run, withMessage } from "./run";
import type { Section } from "./section";
import { NOTHING, type Selection, stillThere } from "./selection";
import { GROW } from "./weights";

export type Line = "closed" | "connecting" | "open" | "lost" | "refused";
export type ToolId =
  | "pull"
  | "subdivide"
  | "retype"
  | "cut"
  | "add"
  | "box"
  | "lasso"
  | "ring"
  | "row"
  | "loop"
  | "part"
  | "band"
  | "graft"
  | "weigh";

const PANELS = ["net", "cells", "framework", "evolve", "graft", "history"] as const;

export type PanelId = (typeof PANELS)[number];

/** How the net is shown. */
export interface View {
  colour: ColourChoice;
  /** Whether springs are drawn thicker the more they have of what they are coloured by. */
  thickness: boolean;
  cells: boolean;
  nodes: boolean;
  anchors: boolean;
  reactions: boolean;
  section: Section | null;
}

/** What an action would do, while somebody considers it. */
export interface Preview {
  label: string;
  /** null: it can't be done. */
  state: PreviewState | null;
  problem: string;
}

/** What the pointer is over, and where on the page [px]. */
export interface Hover {
  kind: "node" | "spring" | "cell";
  row: number;
  x: number;
  y: number;
  /** Width and height of the view [px]. */
  room: [number, number];
}

export interface Notice {
  id: number;
  text: string;
}

export interface State {
  line: Line;
  problem: string;
  document: DocumentState | null;
  net: Net | null;
  motion: Motion | null;
  run: Run | null;
  live: LiveState | null;
  /** Factor that the brush gives to cells; null takes factors away. */
  brush: number | null;
  individuals: Individuals;
  /** Brushes on axes of the individuals. */
  brushes: Brushes;
  /** What individuals are sorted by, wherever they are shown. */
  sort: Sort;
  /** Pinned nets. */
  pins: PinState[];
  /** Whether the gallery shows what is pinned only. */
  pinnedOnly: boolean;
  /** Nets that are marked for a comparison, two at most. */
  marked: string[];
  /** The panel in front. */
  panel: PanelId;
  /** Whether the individuals of the run are shown under the net. */
  gallery: boolean;
  preview: Preview | null;
  selection: Selection;
  hover: Hover | null;
  tool: ToolId;
  /** Type that the brush gives to cells. */
  brushType: string;
  /** Radius of brushes [px]; the least takes only the cell under the pointer. */
  brushRadius: number;
  /** Where a brush is over the view [px]; null without a brush there. */
  brushAt: [number, number] | null;
  view: View;
  theme: Theme;
  /** Actions that are asked for and not answered, so that the document here may not be the engine's any more. */
  awaited: number;
  /** What is waited for; empty if everything comes at once. */
  busy: string;
  /** The last problem, for a toast. */
  notice: Notice | null;
}

const VIEW: View = {
  colour: { by: "force", palette: "plasma", mode: "full", logarithmic: false, fixed: [0, 1] },
  thickness: false,
  cells: false,
  nodes: false,
  anchors: true,
  reactions: false,
  section: null,
};

/** Sizes of brushes [px]. */
export const BRUSH_RADII = [6, 18, 36, 64];

const KEPT = "springform view";

function keptView(): Pick<State, "view" | "theme"> {
  const dark = !matchMedia("(prefers-color-scheme: light)").matches;
  const theme: Theme = dark ? "dark" : "light";
  try {
    const kept = JSON.parse(localStorage.getItem(KEPT) ?? "{}") as Partial<
      Pick<State, "view" | "theme">
    >;
    return {
      theme: kept.theme ?? theme,
      view: { ...VIEW, ...kept.view, colour: { ...VIEW.colour, ...kept.view?.colour } },
    };
  } catch {
    return { theme, view: VIEW };
  }
}

export const store = createStore<State>()(() => ({
  line: "closed",
  problem: "",
  document: null,
  net: null,
  motion: null,
  run: null,
  live: null,
  brush: GROW,
  individuals: NO_INDIVIDUALS,
  brushes: {},
  sort: SORT,
  pins: [],
  pinnedOnly: false,
  marked: [],
  panel: "net",
  gallery: false,
  preview: null,
  selection: NOTHING,
  hover: null,
  tool: "pull",
  brushType: "6",
  brushRadius: BRUSH_RADII[0],
  brushAt: null,
  awaited: 0,
  busy: "",
  notice: null,
  ...keptView(),
}));

store.subscribe(({ view, theme }, before) => {
  if (view !== before.view || theme !== before.theme)
    localStorage.setItem(KEPT, JSON.stringify({ view, theme }));
});

const KEPT_PANEL = "springform panel";

/** The panel of a document that is in front again after its window was loaded anew. */
function keptPanel(id: string): PanelId {
  const [kept, panel] = (sessionStorage.getItem(KEPT_PANEL) ?? "").split(" ");
  return (kept === id && PANELS.find((one) => one === panel)) || "net";
}

store.subscribe(({ panel, document }, before) => {
  if (document && (panel !== before.panel || !before.document))
    sessionStorage.setItem(KEPT_PANEL, `${document.document} ${panel}`);
});

let connection: Connection | null = null;
let notices = 0;

/** Opens a document in this window; an empty id closes the one that is open. */
export function openDocument(id: string): void {
  connection?.close();
  connection = null;
  coming = null;
  const closed = {
    document: null,
    net: null,
    motion: null,
    run: null,
    live: null,
    individuals: NO_INDIVIDUALS,
    brushes: {},
    pins: [],
    pinnedOnly: false,
    marked: [],
    panel: keptPanel(id),
    preview: null,
    selection: NOTHING,
    hover: null,
    notice: null,
  };
  store.setState({ ...closed, line: id ? "connecting" : "closed", problem: "" });
  if (!id) return;
  connection = new Connection(id, {
    event: takeEvent,
    frame: takeFrame,
    line: (line, problem = "") => {
      // After the line was lost the engine sends the whole net anew.
      store.setState(line === "lost" ? { line, problem, hover: null } : { line, problem });
    },
  });
}

onWaits((busy) => store.setState({ busy }));

/** What is asked for and not answered. */
const asked = new Set<string>();

/**
 * Asks the engine to do something. Failures become a notice. What is asked for already is not asked for twice:
 * somebody pressed a button twice. `take` is given the reply before anything else has its turn; by default it selects
 * the cells that were made.
 * Resolves to the reply, or to null if it failed or is on its way.
 */
export async function ask(
  request: Asking,
  label: string,
  take = selectingMade(),
): Promise<Reply | null> {
  const words = JSON.stringify(request);
  if (asked.has(words)) return null;
  asked.add(words);
  store.setState({ awaited: asked.size });
  const reply = await orNotice(askQuietly(request, label));
  asked.delete(words);
  if (reply) take(reply);
  store.setState({ awaited: asked.size });
  return reply;
}

function selectingMade(): (reply: Reply) => void {
  const answer = selecting();
  return ({ cells }) => {
    if (cells.length) answer({ kind: "cells", keys: cells });
  };
}

/** What comes of something; failures become a notice, and null; success ends that of what failed before. */
export async function orNotice<T>(work: Promise<T>): Promise<T | null> {
  const told = notices;
  try {
    const result = await work;
    if (told === notices) forgetNotice();
    return result;
  } catch (error) {
    notify((error as Error).message);
    return null;
  }
}

/** Asks the engine something and leaves it to the caller to say what is wrong; throws `Refused`. */
export async function askQuietly(request: Asking, label: string): Promise<Reply> {
  if (!connection) throw new Error("no document is open");
  return connection.ask(request, label);
}

/** Tells the engine something that it does not answer. */
export function tell(request: Telling): void {
  connection?.tell(request);
}

/** Shows a problem to the person. */
export function notify(text: string): void {
  store.setState({ notice: { id: ++notices, text } });
}

/** Brings a panel to the front. */
export function openPanel(panel: PanelId): void {
  store.setState({ panel });
}

/** Takes back the problem that was shown: things go on. */
export function forgetNotice(): void {
  if (store.getState().notice) store.setState({ notice: null });
}

/** Changes how the net is shown. */
export function changeView(change: Partial<View>): void {
  store.setState(({ view }) => ({ view: { ...view, ...change } }));
}

/** Changes how springs are coloured. */
export function changeColour(change: Partial<ColourChoice>): void {
  store.setState(({ view }) => ({ view: { ...view, colour: { ...view.colour, ...change } } }));
}

let choices = 0;

/** Selects what a person chose. */
export function select(selection: Selection): void {
  choices += 1;
  store.setState({ selection });
}

/** What selects an answer of the engine, unless the person has chosen something since it was asked. */
export function selecting(): (selection: Selection) => void {
  const asked = choices;
  return (selection) => {
    if (asked === choices) store.setState({ selection });
  };
}

function takeEvent(event: Protocol["event"]): void {
  if (event.type === "document") store.setState({ document: event });
  if (event.type === "problem") notify(event.message);
  if (event.type === "run") takeRun(event);
  if (event.type === "pins") store.setState({ pins: event.pins });
  if (event.type === "live") store.setState({ live: event });
  if (event.type === "patches") grafting.setState({ patches: event });
}

const TABLE_EVERY = 500; // ms
let tableTimer = 0;

function takeRun(state: RunState): void {
  const before = store.getState().run;
  const other = before?.state.folder !== state.folder;
  store.setState({
    run: withMessage(before, state),
    ...(other ? { individuals: NO_INDIVIDUALS, brushes: {}, marked: [] } : {}),
  });
  if (tableTimer || state.generations === 0) return;
  tableTimer = window.setTimeout(async () => {
    tableTimer = 0;
    const { run, individuals } = store.getState();
    const known = individuals.springs.length / individuals.population;
    if (!run || known >= run.state.generations) return;
    try {
      const more = await moreIndividuals(individuals);
      if (store.getState().run?.state.folder === run.state.folder)
        store.setState({ individuals: more });
    } catch (error) {
      notify((error as Error).message);
    }
  }, TABLE_EVERY);
}

/** A net of live evolution whose first frame of motion is on its way. */
let coming: Net | null = null;

function takeFrame({ header, arrays }: Frame): void {
  const { net, motion, live } = store.getState();
  if (header.frame === "net") {
    const next = applyNet(coming ?? net, header, arrays);
    // New nets come many times a second then: the one before can be picked and pulled until this one is placed.
    const waits = motion !== null && live !== null && live.status !== "none";
    coming = waits ? next : null;
    // Otherwise nothing is known of the new net's positions until the first frame of motion comes.
    if (!waits) takeNet(next, null);
    return;
  }
  if (header.frame !== "motion") return;
  tell({ type: "received" });
  const placed = coming ?? net;
  if (!placed || header.revision !== placed.revision) return;
  if (coming) takeNet(coming, motionOf(header, arrays));
  else store.setState({ motion: motionOf(header, arrays) });
}

function takeNet(net: Net, motion: Motion | null): void {
  coming = null;
  const { selection } = store.getState();
  store.setState({
    net,
    motion,
    hover: null,
    preview: null,
    selection: stillThere(selection, net),
  });
}
