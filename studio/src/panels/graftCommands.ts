// Commands of selecting cells and of grafting, and whether edits go to the whole orbit.
import { grafting } from "../document/grafting";
import {
  applyGraft,
  copyPatch,
  freeName,
  invertSelection,
  mayApply,
  placesSeenFrom,
  selectAll,
  selectBestAnchor,
  selectBy,
  turnGhost,
} from "../document/planning";
import { selectedRows } from "../document/selection";
import { openPanel, type State, store, type ToolId } from "../document/store";
import { wordsOf } from "../tools/selecting";
import type { Command } from "./commands";

const needsCells = ({ selection }: State) =>
  selection.kind === "cells" && selection.keys.length ? null : "select cells first";
const needsGhost = () => (grafting.getState().chosen ? null : "take a patch first");
const inHand = ({ tool }: State) => tool === "graft";
const tool = (id: ToolId) => () => store.setState({ tool: id });

function gather(by: "row" | "loop" | "part" | "band"): () => void {
  return () => {
    const { net, selection } = store.getState();
    const rows = net ? selectedRows(net, selection, "cells") : [];
    const words = new Set(rows.map((row) => wordsOf(net!, by, row)));
    selectBy({ words: [...words].slice(0, 100).join(" + ") }, true);
  };
}

function grow(by: number): () => void {
  return () => selectBy({ cells: store.getState().selection.keys, grow: by }, false);
}

export function toggleLock(): void {
  grafting.setState(({ lock }) => ({ lock: !lock }));
}

export const GRAFT_COMMANDS: Command[] = [
  {
    id: "ghost-rotate",
    label: "Rotate the ghost one step",
    group: "Grafting",
    keys: "R",
    when: inHand,
    refused: needsGhost,
    run: () => turnGhost({ rotate: 1 }),
  },
  {
    id: "ghost-mirror",
    label: "Mirror the ghost",
    group: "Grafting",
    keys: "M",
    when: inHand,
    refused: needsGhost,
    run: () => turnGhost({ mirror: true }),
  },
  {
    id: "graft-apply",
    label: "Apply the graft",
    group: "Grafting",
    keys: "Enter",
    when: inHand,
    refused: () => needsGhost() ?? (mayApply() ? null : "click a cell or an anchor first"),
    acts: true,
    run: () => void applyGraft(),
  },
  {
    id: "copy-patch",
    label: "Copy the selected cells as a patch",
    group: "Grafting",
    refused: needsCells,
    run: () => {
      openPanel("graft");
      copyPatch(freeName(), placesSeenFrom()[0]);
    },
  },
  {
    id: "lock",
    label: "Symmetry lock: edit whole orbits",
    group: "Grafting",
    keys: "Y",
    run: toggleLock,
  },
  { id: "tool-box", label: "Select by a box", group: "Selecting", keys: "Q", run: tool("box") },
  {
    id: "tool-lasso",
    label: "Select by a lasso",
    group: "Selecting",
    keys: "Shift+L",
    run: tool("lasso"),
  },
  {
    id: "tool-ring",
    label: "Select rings round an anchor",
    group: "Selecting",
    keys: "O",
    run: tool("ring"),
  },
  {
    id: "best-anchor",
    label: "Select rings round the best anchor, where the largest force is least",
    group: "Selecting",
    acts: true,
    run: selectBestAnchor,
  },
  { id: "tool-row", label: "Select rows", group: "Selecting", keys: "Shift+Q", run: tool("row") },
  {
    id: "tool-loop",
    label: "Select loops",
    group: "Selecting",
    keys: "Shift+E",
    run: tool("loop"),
  },
  {
    id: "tool-part",
    label: "Select cylinders",
    group: "Selecting",
    keys: "Shift+O",
    run: tool("part"),
  },
  {
    id: "tool-band",
    label: "Select cells of the same force",
    group: "Selecting",
    keys: "J",
    run: tool("band"),
  },
  {
    id: "grow",
    label: "Grow the selection",
    group: "Selecting",
    keys: "]",
    refused: needsCells,
    acts: true,
    run: grow(1),
  },
  {
    id: "shrink",
    label: "Shrink the selection",
    group: "Selecting",
    keys: "[",
    refused: needsCells,
    acts: true,
    run: grow(-1),
  },
  {
    id: "invert",
    label: "Invert the selection",
    group: "Selecting",
    keys: "I",
    acts: true,
    run: invertSelection,
  },
  {
    id: "all",
    label: "Select all cells",
    group: "Selecting",
    keys: "Ctrl+A",
    acts: true,
    run: selectAll,
  },
  {
    id: "to-rows",
    label: "Extend the selection to rows",
    group: "Selecting",
    refused: needsCells,
    acts: true,
    run: gather("row"),
  },
  {
    id: "to-loops",
    label: "Extend the selection to loops",
    group: "Selecting",
    refused: needsCells,
    acts: true,
    run: gather("loop"),
  },
  {
    id: "to-parts",
    label: "Extend the selection to cylinders",
    group: "Selecting",
    refused: needsCells,
    acts: true,
    run: gather("part"),
  },
  {
    id: "to-band",
    label: "Extend the selection to cells of the same force",
    group: "Selecting",
    refused: needsCells,
    acts: true,
    run: gather("band"),
  },
  {
    id: "to-orbit",
    label: "Extend the selection to its orbit",
    group: "Selecting",
    refused: needsCells,
    acts: true,
    run: () => selectBy({ cells: store.getState().selection.keys, orbit: true }, true),
  },
];
