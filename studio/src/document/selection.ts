// What is selected, by keys, so that it outlives changes of the net.
import type { Net } from "./net";

/** Cells by address, springs as pairs of node keys, or nodes by key. */
export interface Selection {
  kind: "cells" | "springs" | "nodes";
  keys: string[];
}

export const NOTHING: Selection = { kind: "cells", keys: [] };

/** The key of a spring: its end nodes. */
export function springKey(net: Net, spring: number): string {
  return `${net.nodes[net.ends[2 * spring]]} ${net.nodes[net.ends[2 * spring + 1]]}`;
}

const rowsOfNets = new WeakMap<Net, Map<string, Map<string, number>>>();

/** Rows of a net by key. */
export function rowsByKey(net: Net, kind: Selection["kind"]): Map<string, number> {
  let kinds = rowsOfNets.get(net);
  if (!kinds) {
    kinds = new Map();
    rowsOfNets.set(net, kinds);
  }
  let rows = kinds.get(kind);
  if (!rows) {
    const keys =
      kind === "cells"
        ? net.addresses
        : kind === "nodes"
          ? net.nodes
          : Array.from({ length: net.ends.length / 2 }, (_, spring) => springKey(net, spring));
    rows = new Map(keys.map((key, row) => [key, row]));
    kinds.set(kind, rows);
  }
  return rows;
}

/** Rows that are selected and there. */
export function selectedRows(net: Net, selection: Selection, kind: Selection["kind"]): number[] {
  if (selection.kind !== kind) return [];
  const rows = rowsByKey(net, kind);
  return selection.keys.map((key) => rows.get(key)).filter((row) => row !== undefined);
}

/** The selection with what a click adds or takes away. */
export function clicked(
  before: Selection,
  kind: Selection["kind"],
  key: string,
  adding: boolean,
): Selection {
  if (!adding || before.kind !== kind) return { kind, keys: [key] };
  const others = before.keys.filter((other) => other !== key);
  return { kind, keys: others.length < before.keys.length ? others : [...before.keys, key] };
}

/** What of a selection is in a net; cells that were divided or merged are followed to what is in their place. */
export function stillThere(selection: Selection, net: Net): Selection {
  const rows = rowsByKey(net, selection.kind);
  if (selection.keys.every((key) => rows.has(key))) return selection;
  if (selection.kind !== "cells")
    return { ...selection, keys: selection.keys.filter((key) => rows.has(key)) };
  const within = cellsWithinCells(net);
  const keys = selection.keys.flatMap((key) => {
    const above = upwards(key).find((address) => rows.has(address));
    return above === undefined ? (within.get(key) ?? []) : [above];
  });
  return { ...selection, keys: [...new Set(keys)] };
}

/** An address and those of the cells that it is part of. */
function upwards(address: string): string[] {
  const steps = address.split(".");
  return steps.map((_, short) => steps.slice(0, steps.length - short).join("."));
}

/** The cells of a net by every cell that they are part of. */
function cellsWithinCells(net: Net): Map<string, string[]> {
  const within = new Map<string, string[]>();
  for (const address of net.addresses)
    for (const above of upwards(address).slice(1)) {
      const known = within.get(above);
      if (known) known.push(address);
      else within.set(above, [address]);
    }
  return within;
}
