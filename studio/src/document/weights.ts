// Factors that were brushed on cells: where evolution is to grow, and what it is to keep out of.

import { groupOf, type Net } from "./net";

/** Factor that the brush gives to cells that are to grow. */
export const GROW = 100;

/** The factor of a cell: its own, or that of the cell it descends from; 1 if there is none. */
export function factorOf(weights: Record<string, number>, address: string): number {
  for (let cell = address; ; cell = cell.slice(0, cell.lastIndexOf("."))) {
    const factor = weights[cell];
    if (factor !== undefined) return factor;
    if (!cell.includes(".")) return 1;
  }
}

/** Cells where the net is to grow, or that evolution keeps out of, and their springs; null: there are none. */
export function springsIn(
  net: Net,
  weights: Record<string, number>,
  grow: boolean,
): { cells: number; springs: number } | null {
  const springs = new Set<number>();
  let cells = 0;
  net.addresses.forEach((address, cell) => {
    const factor = factorOf(weights, address);
    if (grow ? factor <= 1 : factor >= 1) return;
    cells += 1;
    for (const spring of groupOf(net.own, cell)) springs.add(spring);
  });
  return cells ? { cells, springs: springs.size } : null;
}
