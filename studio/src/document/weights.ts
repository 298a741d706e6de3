// Factors that were brushed on cells: where evolution is to grow, and what it is to keep out of.

/** Factor that the brush gives to cells that are to grow. */
export const GROW = 8;

/** The factor of a cell: its own, or that of the cell it descends from; 1 if there is none. */
export function factorOf(weights: Record<string, number>, address: string): number {
  for (let cell = address; ; cell = cell.slice(0, cell.lastIndexOf("."))) {
    const factor = weights[cell];
    if (factor !== undefined) return factor;
    if (!cell.includes(".")) return 1;
  }
}
