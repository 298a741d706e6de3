// Every command of the studio, once: for keys, menus, the palette and the sheet of keys.
import { isComparing } from "../document/comparing";
import { isEvolving, notEditable } from "../document/editable";
import { grafting } from "../document/grafting";
import { plainType } from "../document/quantities";
import { inFull } from "../document/scale";
import { NOTHING, selectedRows, springKey } from "../document/selection";
import { startRun } from "../document/starting";
import { ask, openPanel, type State, select, store, type ToolId } from "../document/store";
import { inTurn } from "../document/turns";
import { resizeBrush } from "../tools/brush";
import type { Viewport } from "../viewport/scene";
import { CHOOSING_COMMANDS } from "./choosingCommands";
import { clearMarks, discardGrown, keepGrown, restoreGrown } from "./confirming";
import { exportDrawing, exportModel, exportPicture, MODELS } from "./exporting";
import { GRAFT_COMMANDS } from "./graftCommands";
import { support } from "./NodeSection";
import { VIEW_COMMANDS } from "./viewCommands";

export const GROUPS = [
  "Net",
  "Cells",
  "Selecting",
  "Grafting",
  "Choosing",
  "Springs and nodes",
  "Tools",
  "View",
  "Document",
] as const;

export type Group = (typeof GROUPS)[number];

export interface Command {
  id: string;
  label: string;
  /** Other words that people look for it by. */
  words?: string;
  group: Group;
  /** Keys as `KeyboardEvent.key` names them, `Ctrl+` and `Shift+` before them. */
  keys?: string;
  /** Whether its keys mean it now; always if left out. */
  when?(state: State): boolean;
  /** Whether it can be done now; if not, why. */
  refused?(state: State): string | null;
  /** Whether it acts on the document, and so waits for answers that are on their way. */
  acts?: boolean;
  run(stage: { viewport: Viewport | null; dialogs: Dialogs }): void;
}

/** What opens over the page. */
export interface Dialogs {
  open(dialog: "palette" | "keys" | "save" | "start"): void;
}

const oneSpring = ({ selection }: State) =>
  selection.kind === "springs" && selection.keys.length === 1 ? null : "select one spring first";

// Each for what edits them.
const needsCells = (state: State) =>
  notEditable(state) ??
  (state.selection.kind === "cells" && state.selection.keys.length ? null : "select cells first");
const needsOneNode = (state: State) =>
  notEditable(state) ??
  (state.selection.kind === "nodes" && state.selection.keys.length === 1
    ? null
    : "select one node first");
const needsSpring = (state: State) => notEditable(state) ?? oneSpring(state);

const needsLive = (state: State) => (isEvolving(state) ? null : "nothing evolves live");

function cells(): string[] {
  const { selection } = store.getState();
  return selection.kind === "cells" ? selection.keys : [];
}

/** Whether the selected node is an anchor. */
function onAnchor({ net, selection }: State): boolean {
  return !!net && selectedRows(net, selection, "nodes").some((row) => net.anchors.includes(row));
}

function editCells(what: "subdivide" | "off" | "on" | "turn", label: string): () => void {
  return () => {
    ask(
      { type: "edit_cells", what, cells: cells(), kind: null, orbit: grafting.getState().lock },
      label,
    );
  };
}

/** Gives the selected cells a type. */
export function retype(kind: string): void {
  inTurn(() => {
    const { net, selection } = store.getState();
    const rows = net ? selectedRows(net, selection, "cells") : [];
    const other = rows.some((row) => plainType(net!.types[row]) !== kind);
    const orbit = grafting.getState().lock;
    if (other)
      ask({ type: "edit_cells", what: "retype", cells: cells(), kind, orbit }, "Changing the type");
  });
}

export function undo(redo: boolean): void {
  ask({ type: "undo", redo }, redo ? "Redoing" : "Undoing");
}

export function move(what: "run" | "pause" | "step" | "reset"): void {
  ask({ type: "move", what }, "Moving the net");
}

export function seek(steps: number): void {
  inTurn(() => {
    const { document } = store.getState();
    const kind = document?.cell_types.find(({ word }) => word === "1")?.word ?? "1";
    const orbit = grafting.getState().lock;
    ask({ type: "seek_stress", steps, kind, orbit }, `Seeking stress, ${inFull(steps)} steps`);
  });
}

const BAND = 0.1; // of the force, on each side

/** Selects the springs whose force is near that of the selected one. */
function selectSameForce(): void {
  const { net, motion, selection } = store.getState();
  const row = net ? selectedRows(net, selection, "springs")[0] : undefined;
  if (!net || !motion || row === undefined) return;
  const force = motion.forces[row];
  const near = [...motion.forces.keys()].filter(
    (spring) => Math.abs(motion.forces[spring] - force) <= BAND * Math.abs(force),
  );
  select({ kind: "springs", keys: near.map((spring) => springKey(net, spring)) });
}

/** Selects the spring that carries most, or least. */
export function selectExtreme(most: boolean): () => void {
  return () => {
    const { net, motion } = store.getState();
    if (!net || !motion?.forces.length) return;
    const best = [...motion.forces.keys()].reduce((one, other) =>
      motion.forces[other] > motion.forces[one] === most ? other : one,
    );
    select({ kind: "springs", keys: [springKey(net, best)] });
  };
}

const tool = (id: ToolId) => () => store.setState({ tool: id });

const withBrush = ({ tool }: State) =>
  tool === "subdivide" || tool === "retype" || tool === "weigh";

export const COMMANDS: Command[] = [
  {
    id: "brush-larger",
    label: "Larger brush",
    group: "Tools",
    keys: "]",
    when: withBrush,
    run: () => resizeBrush(1),
  },
  {
    id: "brush-smaller",
    label: "Smaller brush",
    group: "Tools",
    keys: "[",
    when: withBrush,
    run: () => resizeBrush(-1),
  },
  ...CHOOSING_COMMANDS,
  ...GRAFT_COMMANDS,
  {
    id: "run",
    label: "Run or pause form-finding",
    group: "Net",
    keys: "Space",
    run: () => move(store.getState().motion?.header.running ? "pause" : "run"),
  },
  {
    id: "step",
    label: "Make one step",
    group: "Net",
    keys: ".",
    run: () => inTurn(() => move("step")),
  },
  {
    id: "reset",
    label: "Put the net back to where it was drawn",
    group: "Net",
    keys: "Shift+R",
    run: () => move("reset"),
  },
  {
    id: "seek",
    label: "Seek stress, one step",
    group: "Net",
    keys: "G",
    refused: notEditable,
    run: () => seek(1),
  },
  {
    id: "seek10",
    label: "Seek stress, ten steps",
    group: "Net",
    keys: "Shift+G",
    refused: notEditable,
    run: () => seek(10),
  },
  {
    id: "subdivide",
    label: "Subdivide",
    group: "Cells",
    keys: "S",
    refused: needsCells,
    acts: true,
    run: editCells("subdivide", "Subdividing"),
  },
  {
    id: "off",
    label: "Merge with siblings (off)",
    group: "Cells",
    keys: "M",
    refused: (state) =>
      needsCells(state) ??
      (state.selection.keys.every((cell) => cell.includes("."))
        ? null
        : "select parts of subdivided cells"),
    acts: true,
    run: editCells("off", "Merging"),
  },
  {
    id: "on",
    label: "Bring children back (on)",
    group: "Cells",
    keys: "Shift+M",
    refused: needsCells,
    acts: true,
    run: editCells("on", "Bringing back"),
  },
  {
    id: "turn",
    label: "Turn by a quarter",
    group: "Cells",
    keys: "R",
    refused: needsCells,
    acts: true,
    run: editCells("turn", "Turning"),
  },
  {
    id: "largest-force",
    label: "Select the spring with the largest force",
    group: "Selecting",
    run: selectExtreme(true),
  },
  {
    id: "smallest-force",
    label: "Select the spring with the smallest force",
    group: "Selecting",
    run: selectExtreme(false),
  },
  {
    id: "cut",
    label: "Cut the spring",
    group: "Springs and nodes",
    keys: "Delete",
    refused: needsSpring,
    acts: true,
    run: () => {
      const nodes = store.getState().selection.keys[0].split(" ");
      ask({ type: "edit_spring", what: "cut", nodes, orbit: grafting.getState().lock }, "Cutting");
    },
  },
  {
    id: "hold",
    label: "Hold the node as an anchor",
    group: "Springs and nodes",
    keys: "H",
    refused: (state) => needsOneNode(state) ?? (onAnchor(state) ? "it is an anchor" : null),
    acts: true,
    run: () => {
      support(store.getState().selection.keys[0], "xyz");
    },
  },
  {
    id: "let-go",
    label: "Let the anchor go",
    group: "Springs and nodes",
    keys: "Shift+H",
    refused: (state) => needsOneNode(state) ?? (onAnchor(state) ? null : "it is no anchor"),
    acts: true,
    run: () => {
      support(store.getState().selection.keys[0], "free");
    },
  },
  {
    id: "same-force",
    label: "Select springs of about the same force",
    group: "Springs and nodes",
    refused: oneSpring,
    run: selectSameForce,
  },
  {
    id: "slide-x",
    label: "Let the node slide along x",
    group: "Springs and nodes",
    refused: needsOneNode,
    acts: true,
    run: () => support(store.getState().selection.keys[0], "yz"),
  },
  {
    id: "slide-y",
    label: "Let the node slide along y",
    group: "Springs and nodes",
    refused: needsOneNode,
    acts: true,
    run: () => support(store.getState().selection.keys[0], "xz"),
  },
  {
    id: "slide-z",
    label: "Let the node slide along z",
    group: "Springs and nodes",
    refused: needsOneNode,
    acts: true,
    run: () => support(store.getState().selection.keys[0], "xy"),
  },
  { id: "tool-pull", label: "Select and pull", group: "Tools", keys: "V", run: tool("pull") },
  {
    id: "tool-subdivide",
    label: "Subdivide with a brush",
    group: "Tools",
    keys: "B",
    refused: notEditable,
    run: tool("subdivide"),
  },
  {
    id: "tool-retype",
    label: "Give types with a brush",
    group: "Tools",
    keys: "Shift+B",
    refused: notEditable,
    run: tool("retype"),
  },
  {
    id: "tool-cut",
    label: "Cut springs",
    group: "Tools",
    keys: "X",
    refused: notEditable,
    run: tool("cut"),
  },
  {
    id: "tool-add",
    label: "Add springs",
    group: "Tools",
    keys: "A",
    refused: notEditable,
    run: tool("add"),
  },
  {
    id: "tool-weigh",
    label: "Brush where evolution grows",
    group: "Tools",
    keys: "E",
    run: tool("weigh"),
  },
  {
    id: "live",
    label: "Evolve live, or pause it",
    group: "Net",
    keys: "L",
    acts: true,
    run: () => {
      const status = store.getState().live?.status ?? "none";
      const what = {
        none: "start",
        running: "pause",
        paused: "continue",
        failed: "discard",
      } as const;
      ask({ type: "live_evolve", what: what[status], parameters: {} }, "Evolving");
    },
  },
  {
    id: "start-run",
    label: "Evolve: start a run",
    group: "Net",
    run: () => {
      openPanel("evolve");
      startRun();
    },
  },
  {
    id: "live-keep",
    label: "Stop live evolution and keep the net",
    group: "Net",
    refused: needsLive,
    acts: true,
    run: keepGrown,
  },
  {
    id: "live-discard",
    label: "Discard what evolved live",
    group: "Net",
    refused: needsLive,
    acts: true,
    run: discardGrown,
  },
  {
    id: "live-restore",
    label: "Bring back what was discarded",
    group: "Net",
    refused: ({ live }) => (live?.restorable ? null : "nothing was discarded"),
    acts: true,
    run: restoreGrown,
  },
  {
    id: "clear-marks",
    label: "Clear all marks where evolution grows or keeps out",
    group: "Net",
    refused: ({ live }) =>
      Object.keys(live?.weights ?? {}).length ? null : "no cells are brushed",
    acts: true,
    run: clearMarks,
  },
  ...VIEW_COMMANDS,
  {
    id: "undo",
    label: "Undo",
    group: "Document",
    keys: "Ctrl+Z",
    refused: (state) =>
      notEditable(state) ?? (state.document?.position ? null : "nothing was done"),
    acts: true,
    run: () => undo(false),
  },
  {
    id: "redo",
    label: "Redo",
    group: "Document",
    keys: "Ctrl+Shift+Z",
    refused: (state) =>
      notEditable(state) ??
      (state.document && state.document.position < state.document.length
        ? null
        : "nothing was undone"),
    acts: true,
    run: () => undo(true),
  },
  {
    id: "save",
    label: "Save",
    group: "Document",
    keys: "Ctrl+S",
    run: ({ dialogs }) => {
      if (store.getState().document?.file)
        ask({ type: "save", path: null, replace: false }, "Saving");
      else dialogs.open("save");
    },
  },
  {
    id: "save-as",
    label: "Save as …",
    group: "Document",
    keys: "Ctrl+Shift+S",
    run: ({ dialogs }) => dialogs.open("save"),
  },
  {
    id: "picture",
    label: "Export a picture (PNG)",
    words: "screenshot image render",
    group: "Document",
    run: ({ viewport }) => viewport && exportPicture(viewport),
  },
  {
    id: "drawing",
    label: "Export a drawing (SVG)",
    group: "Document",
    refused: () => (isComparing() ? "close the comparison first" : null),
    run: ({ viewport }) => viewport && exportDrawing(viewport),
  },
  ...MODELS.map(({ name, label, words }) => ({
    id: `export-${name}`,
    label: `Export: ${label}`,
    words,
    group: "Document" as const,
    run: () => void exportModel(name),
  })),
  {
    id: "start",
    label: "Open another document",
    group: "Document",
    keys: "Ctrl+O",
    run: ({ dialogs }) => dialogs.open("start"),
  },
  {
    id: "palette",
    label: "Find a command",
    group: "Document",
    keys: "Ctrl+K",
    run: ({ dialogs }) => dialogs.open("palette"),
  },
  {
    id: "keys",
    label: "Show all keys",
    words: "help shortcuts keyboard",
    group: "Document",
    keys: "?",
    run: ({ dialogs }) => dialogs.open("keys"),
  },
  {
    id: "deselect",
    label: "Select nothing",
    group: "Tools",
    keys: "Escape",
    run: () => {
      select(NOTHING);
      if (store.getState().tool !== "pull") store.setState({ tool: "pull" });
    },
  },
];

export function commandOf(id: string): Command {
  const found = COMMANDS.find((command) => command.id === id);
  if (!found) throw new Error(`there is no command ${id}`);
  return found;
}

/** The command that a key press means, if any. */
export function commandOfKey(event: KeyboardEvent): Command | undefined {
  const name =
    event.key === " " ? "Space" : event.key.length === 1 ? event.key.toUpperCase() : event.key;
  const letter = /^[A-Z]$/.test(name);
  const control = event.ctrlKey || event.metaKey ? "Ctrl+" : "";
  // Where Shift only chooses the character, such as ?, it is no part of the key.
  const shift = event.shiftKey && (letter || name.length > 1) ? "Shift+" : "";
  const pressed = `${control}${shift}${name}`;
  const same = pressed === "Backspace" ? "Delete" : pressed === "Ctrl+Y" ? "Ctrl+Shift+Z" : pressed;
  const state = store.getState();
  return COMMANDS.find(({ keys, when }) => keys === same && (when?.(state) ?? true));
}
