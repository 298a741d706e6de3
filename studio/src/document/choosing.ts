// Which individuals of a run are chosen: brushes on axes, shared by all that shows individuals.
import type { Individuals } from "./run";

/** Least and most by axis. */
export type Brushes = Record<string, [number, number]>;

export interface Axis {
  id: string;
  name: string;
  logarithmic?: boolean;
}

export const AXES: Axis[] = [
  { id: "generation", name: "Generation" },
  { id: "springs", name: "Springs" },
  { id: "force_differential", name: "Differential", logarithmic: true },
  { id: "force_max", name: "Largest N" },
  { id: "force_min", name: "Smallest N" },
  { id: "total_length", name: "Length m" },
];

/** Value of an individual on an axis; NaN where undefined. */
export function placeOnAxis(individuals: Individuals, axis: string, row: number): number {
  if (axis === "generation") return Math.floor(row / individuals.population) + 1;
  return individuals.columns[axis]?.[row] ?? Number.NaN;
}

/** 1 for every individual within all brushes; null if nothing is brushed. */
export function maskOf(individuals: Individuals, brushes: Brushes): Uint8Array | null {
  const axes = Object.entries(brushes);
  if (!axes.length) return null;
  const mask = new Uint8Array(individuals.springs.length);
  for (let row = 0; row < mask.length; row++) {
    const inside = axes.every(([axis, [least, most]]) => {
      const value = placeOnAxis(individuals, axis, row);
      return value >= least && value <= most;
    });
    mask[row] = inside && Number.isFinite(individuals.differential[row]) ? 1 : 0;
  }
  return mask;
}

/** Least and most of the values that are known on an axis. */
export function rangeOf(individuals: Individuals, axis: string): [number, number] {
  let [least, most] = [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
  for (let row = 0; row < individuals.springs.length; row++) {
    const value = placeOnAxis(individuals, axis, row);
    if (!Number.isFinite(value)) continue;
    least = Math.min(least, value);
    most = Math.max(most, value);
  }
  return least <= most ? [least, most] : [0, 1];
}
