// The grown net as the engine sends it: nodes, springs and cells in typed arrays, updated by what changed.
import type { Arrays } from "../protocol/frames";
import type { NetHeader } from "../protocol/messages";

/** Lists of rows: those of group g are `items[starts[g]]` to `items[starts[g + 1] - 1]`. */
export interface Groups {
  starts: Int32Array;
  items: Int32Array;
}

/** A net of n nodes, m springs and c expressed cells. Nothing in it changes. */
export interface Net {
  revision: number;
  /** Cylinders and sheets by number. */
  parts: string[];
  /** Keys of nodes, (n). */
  nodes: string[];
  /** Ends of springs, (2 m) rows of nodes. */
  ends: Int32Array;
  /** Level of the deepest cell of a spring, (m). */
  springLevel: Uint8Array;
  springPart: Uint8Array;
  /** 1 along a free ring or rim, (m). */
  springRing: Uint8Array;
  /** Number in `laws`, (m). */
  law: Uint8Array;
  /** 0 pulls only, 1 pulls and pushes, 2 pushes only, (m). */
  sense: Uint8Array;
  /** Cross-section, 0 where unknown, (m) [m2]. */
  area: Float32Array;
  /** (m) [N/m]. */
  stiffness: Float32Array;
  /** (m) [m]. */
  restLength: Float32Array;
  /** (m) [N]. */
  constantForce: Float32Array;
  /** Addresses of cells, (c). */
  addresses: string[];
  /** Types as expressed, (c). */
  types: string[];
  cellLevel: Uint8Array;
  cellPart: Uint8Array;
  /** 1 if the cell keeps children that are switched off, (c). */
  stored: Uint8Array;
  /** Nodes around every cell, corner c0 first. */
  boundaries: Groups;
  /** Springs of every cell. */
  own: Groups;
  /** Rows of the anchors' nodes. */
  anchors: Int32Array;
  anchorNames: string[];
}

/** Makes a net of a frame and the net that it builds on. Throws `Error` if that is another one. */
export function applyNet(before: Net | null, header: NetHeader, arrays: Arrays): Net {
  if (header.base !== null && before?.revision !== header.base) {
    throw new Error(`the frame builds on net ${header.base}`);
  }
  const base = header.base === null ? null : before;
  const nodeRuns = runsOf(arrays.integers("nodes_runs"));
  const springRuns = runsOf(arrays.integers("springs_runs"));
  const cellRuns = runsOf(arrays.integers("cells_runs"));
  const nodes = mergeLists(nodeRuns, base?.nodes ?? [], header.node_keys);
  const nodeAfter = rowsAfter(nodeRuns, base?.nodes.length ?? 0);
  const springAfter = rowsAfter(springRuns, base ? base.ends.length / 2 : 0);
  const bytes = (runs: Run[], kept: Uint8Array | undefined, name: string) =>
    mergeArrays(runs, kept ?? new Uint8Array(), arrays.bytes(name), 1);
  const floats = (kept: Float32Array | undefined, name: string) =>
    mergeArrays(springRuns, kept ?? new Float32Array(), arrays.floats(name), 1);
  const oldEnds = base ? base.ends.map((row) => nodeAfter[row]) : new Int32Array();
  return {
    revision: header.revision,
    parts: header.parts,
    nodes,
    ends: mergeArrays(springRuns, oldEnds, arrays.integers("spring_ends"), 2),
    springLevel: bytes(springRuns, base?.springLevel, "spring_level"),
    springPart: bytes(springRuns, base?.springPart, "spring_part"),
    springRing: bytes(springRuns, base?.springRing, "spring_ring"),
    law: bytes(springRuns, base?.law, "spring_law"),
    sense: bytes(springRuns, base?.sense, "spring_sense"),
    area: floats(base?.area, "area"),
    stiffness: floats(base?.stiffness, "stiffness"),
    restLength: floats(base?.restLength, "rest_length"),
    constantForce: floats(base?.constantForce, "constant_force"),
    addresses: mergeLists(cellRuns, base?.addresses ?? [], header.addresses),
    types: mergeLists(cellRuns, base?.types ?? [], header.types),
    cellLevel: bytes(cellRuns, base?.cellLevel, "cell_level"),
    cellPart: bytes(cellRuns, base?.cellPart, "cell_part"),
    stored: bytes(cellRuns, base?.stored, "cell_stored"),
    boundaries: mergeGroups(cellRuns, base?.boundaries, nodeAfter, arrays, "boundary"),
    own: mergeGroups(cellRuns, base?.own, springAfter, arrays, "own"),
    anchors: arrays.integers("anchors").slice(),
    anchorNames: header.anchor_names,
  };
}

/** Rows of one group. */
export function groupOf(groups: Groups, row: number): Int32Array {
  return groups.items.subarray(groups.starts[row], groups.starts[row + 1]);
}

const cellsBySpring = new WeakMap<Net, Groups>();

/** Cells of every spring. */
export function springCells(net: Net): Groups {
  let found = cellsBySpring.get(net);
  if (!found) {
    found = turnedRound(net.own, net.ends.length / 2);
    cellsBySpring.set(net, found);
  }
  return found;
}

function turnedRound({ starts, items }: Groups, count: number): Groups {
  const after = new Int32Array(count + 1);
  for (const item of items) after[item + 1]++;
  for (let row = 0; row < count; row++) after[row + 1] += after[row];
  const next = after.slice();
  const turned = new Int32Array(items.length);
  for (let group = 0; group + 1 < starts.length; group++) {
    for (let at = starts[group]; at < starts[group + 1]; at++) turned[next[items[at]]++] = group;
  }
  return { starts: after, items: turned };
}

/** Rows of a table: a run of rows of the table before, or new ones where `first` is -1. */
interface Run {
  first: number;
  length: number;
}

function runsOf(flat: Int32Array): Run[] {
  return Array.from({ length: flat.length / 2 }, (_, run) => ({
    first: flat[2 * run],
    length: flat[2 * run + 1],
  }));
}

function mergeLists<T>(runs: Run[], before: T[], fresh: T[]): T[] {
  let taken = 0;
  return runs.flatMap(({ first, length }) => {
    if (first >= 0) return before.slice(first, first + length);
    taken += length;
    return fresh.slice(taken - length, taken);
  });
}

type Numbers = Float32Array | Int32Array | Uint8Array;

function mergeArrays<T extends Numbers>(runs: Run[], before: T, fresh: T, width: number): T {
  const rows = runs.reduce((sum, run) => sum + run.length, 0);
  const merged = new (fresh.constructor as new (length: number) => T)(rows * width);
  let at = 0;
  let taken = 0;
  for (const { first, length } of runs) {
    const size = length * width;
    const source = first >= 0 ? before : fresh;
    const from = first >= 0 ? first * width : taken;
    merged.set(source.subarray(from, from + size) as never, at);
    if (first < 0) taken += size;
    at += size;
  }
  return merged;
}

function rowsAfter(runs: Run[], count: number): Int32Array {
  const after = new Int32Array(count).fill(-1);
  let at = 0;
  for (const { first, length } of runs) {
    if (first >= 0) for (let row = 0; row < length; row++) after[first + row] = at + row;
    at += length;
  }
  return after;
}

function mergeGroups(
  runs: Run[],
  before: Groups | undefined,
  itemsAfter: Int32Array,
  arrays: Arrays,
  name: string,
): Groups {
  const counts = arrays.integers(`${name}_counts`);
  const fresh = arrays.integers(`${name}_items`);
  const oldCounts = before
    ? before.starts.subarray(1).map((end, row) => end - before.starts[row])
    : new Int32Array();
  const allCounts = mergeArrays(runs, oldCounts, counts, 1);
  const starts = new Int32Array(allCounts.length + 1);
  for (let row = 0; row < allCounts.length; row++) starts[row + 1] = starts[row] + allCounts[row];
  const items = new Int32Array(starts[allCounts.length]);
  let at = 0;
  let taken = 0;
  let row = 0;
  for (const { first, length } of runs) {
    const size = starts[row + length] - starts[row];
    if (first < 0) {
      items.set(fresh.subarray(taken, taken + size), at);
      taken += size;
    } else {
      const from = before!.starts[first];
      for (let item = 0; item < size; item++)
        items[at + item] = itemsAfter[before!.items[from + item]];
    }
    at += size;
    row += length;
  }
  return { starts, items };
}
