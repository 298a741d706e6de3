// Which individuals of a run are chosen, and in which order: brushes and one sort key, shared by all that shows them.
import type { Individuals } from "./run";

/** Least and most by axis. */
export type Brushes = Record<string, [number, number]>;

export interface Axis {
  id: string;
  name: string;
  logarithmic?: boolean;
  /** Whether its values are counts. */
  counts?: boolean;
}

export const AXES: Axis[] = [
  { id: "generation", name: "Generation", counts: true },
  { id: "springs", name: "Springs", counts: true },
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

/** What individuals are sorted by. */
export interface Measure {
  id: string;
  name: string;
  /** What it is, in words. */
  explains: string;
  unit: string;
  /** Whether its values are counts. */
  counts?: boolean;
}

export const MEASURES: Measure[] = [
  {
    id: "force_differential",
    name: "Force differential",
    explains: "largest over smallest force",
    unit: "",
  },
  {
    id: "suf",
    name: "Spring utilization factor",
    explains: "rise of the differential for every spring that came",
    unit: "",
  },
  { id: "springs", name: "Springs", explains: "how dense the net is", unit: "", counts: true },
  { id: "force_max", name: "Largest force", explains: "of all springs, in N", unit: "N" },
  { id: "force_min", name: "Smallest force", explains: "of all springs, in N", unit: "N" },
  { id: "total_length", name: "Total length", explains: "of all springs, in m", unit: "m" },
  { id: "shortest_spring", name: "Shortest spring", explains: "in m", unit: "m" },
  { id: "generation", name: "Generation", explains: "when it was made", unit: "", counts: true },
];

/** The sort key of a window. */
export interface Sort {
  by: string;
  descending: boolean;
  /** Whether the gallery has a row a generation, each sorted; otherwise it is one ranking. */
  byGeneration: boolean;
}

export const SORT: Sort = { by: "force_differential", descending: false, byGeneration: true };

export function measureOf({ by }: Sort): Measure {
  return MEASURES.find(({ id }) => id === by) ?? MEASURES[0];
}

/** Individuals in the order of a sort key. */
export interface Ranking {
  /** Rows of the chosen ones, the first first; those whose measure is undefined come last. */
  rows: Uint32Array;
  /** How many of them have the measure. */
  known: number;
  /** Place of every individual in `rows`, from 0; -1 for one that is not chosen. */
  place: Int32Array;
}

let last: { of: [Individuals, Sort["by"], boolean, Brushes]; ranking: Ranking } | null = null;

/** The ranking of what is brushed; made once for all that show it. */
export function rankingOf(individuals: Individuals, sort: Sort, brushes: Brushes): Ranking {
  const of: [Individuals, string, boolean, Brushes] = [
    individuals,
    sort.by,
    sort.descending,
    brushes,
  ];
  if (!last?.of.every((part, at) => part === of[at]))
    last = { of, ranking: ranked(individuals, sort, maskOf(individuals, brushes)) };
  return last!.ranking;
}

const UNDEFINED = 0xffffffff;
const EXACT_BITS = 21;

/** Ties go to the lower row. Sorted as packed numbers, since comparing in a function blocks the page for long. */
export function ranked(
  individuals: Individuals,
  { by, descending }: Pick<Sort, "by" | "descending">,
  mask: Uint8Array | null,
): Ranking {
  const count = individuals.springs.length;
  const bits = Math.ceil(Math.log2(count + 1));
  const scale = 2 ** bits;
  // 53 bits hold a value and a row; beyond two million rows the last bits of values are left out.
  const coarse = 2 ** Math.max(0, bits - EXACT_BITS);
  const values = new Float32Array(count);
  // The zero that is added leaves one kind of zero.
  for (let row = 0; row < count; row++) values[row] = placeOnAxis(individuals, by, row) + 0;
  const patterns = new Uint32Array(values.buffer);
  const packed = new Float64Array(count);
  let chosen = 0;
  let known = 0;
  for (let row = 0; row < count; row++) {
    if (mask && !mask[row]) continue;
    const pattern = patterns[row];
    // In this order of bits numbers ascend as their values do, negative ones too.
    const rising = pattern >>> 31 ? ~pattern >>> 0 : (pattern | 0x80000000) >>> 0;
    const finite = Number.isFinite(values[row]);
    const key = finite ? (descending ? UNDEFINED - 1 - rising : rising) : UNDEFINED;
    if (finite) known++;
    packed[chosen++] = Math.floor(key / coarse) * scale + row;
  }
  const sorted = packed.subarray(0, chosen).sort();
  const rows = new Uint32Array(chosen);
  const place = new Int32Array(count).fill(-1);
  for (let at = 0; at < chosen; at++) {
    rows[at] = sorted[at] % scale;
    place[rows[at]] = at;
  }
  return { rows, known, place };
}

/** A ranking parted by generation: rows of `generations[at]` are `rows[starts[at]]` to `rows[starts[at + 1] - 1]`. */
export interface Parted {
  /** Those with somebody to show, the newest first. */
  generations: number[];
  starts: number[];
  rows: Uint32Array;
}

export function byGeneration({ population, springs }: Individuals, chosen: Uint32Array): Parted {
  const generations = Math.floor(springs.length / population);
  const sizes = new Uint32Array(generations);
  for (const row of chosen) sizes[Math.floor(row / population)]++;
  const parted: Parted = { generations: [], starts: [0], rows: new Uint32Array(chosen.length) };
  const next = new Uint32Array(generations);
  let sum = 0;
  for (let at = generations - 1; at >= 0; at--) {
    if (!sizes[at]) continue;
    next[at] = sum;
    sum += sizes[at];
    parted.generations.push(at + 1);
    parted.starts.push(sum);
  }
  for (const row of chosen) parted.rows[next[Math.floor(row / population)]++] = row;
  return parted;
}

/** Where an individual stands in a ranking, from 0 (first) to 1; undefined measures stand last. */
export function shareOfPlace({ known }: Ranking, place: number): number {
  return known > 1 ? Math.min(1, place / (known - 1)) : 0;
}
