// The run of the document: what every generation gave, and all individuals, as the engine tells them.
import { documentInAddress } from "../protocol/address";
import { fetchTable } from "../protocol/fetching";
import type { GenerationRow, RunState } from "../protocol/messages";

/** The run as this window knows it. */
export interface Run {
  state: RunState;
  /** One row a generation. */
  rows: GenerationRow[];
}

/** Whether a run that stands can go on: it was paused or stopped, and has not reached its end. */
export function mayContinue({ state: { status, reason } }: Run): boolean {
  return status !== "running" && (status !== "ended" || reason === "it was stopped");
}

/** Springs and force differential of all individuals, in order of generation and number. */
export interface Individuals {
  population: number;
  springs: Float32Array;
  /** NaN where undefined. */
  differential: Float32Array;
  /** Every axis by its name, those two among them. */
  columns: Record<string, Float32Array>;
}

export const NO_INDIVIDUALS: Individuals = {
  population: 1,
  springs: new Float32Array(),
  differential: new Float32Array(),
  columns: {},
};

/** The run after a message: rows from `first` on are new. */
export function withMessage(before: Run | null, state: RunState): Run {
  const kept = before?.state.folder === state.folder ? before.rows.slice(0, state.first - 1) : [];
  return { state, rows: [...kept, ...state.rows] };
}

/** Fetches the individuals that are not known yet. */
export async function moreIndividuals(before: Individuals): Promise<Individuals> {
  const known = Math.floor(before.springs.length / before.population);
  const { header, arrays } = await fetchTable(documentInAddress(), known + 1);
  if (header.frame !== "table") throw new Error("the engine sent no table");
  const joined = (name: string) => {
    const old = before.columns[name] ?? new Float32Array();
    const fresh = arrays.floats(name);
    const all = new Float32Array(old.length + fresh.length);
    all.set(old);
    all.set(fresh, old.length);
    return all;
  };
  const columns = Object.fromEntries(header.arrays.map(({ name }) => [name, joined(name)]));
  return {
    population: header.population,
    springs: columns.springs,
    differential: columns.force_differential,
    columns,
  };
}

/** Rows of the Pareto set: no other has as many springs at a lower differential. Ascending in springs. */
export function paretoOf({ springs, differential }: Individuals): number[] {
  const least = new Map<number, number>();
  for (let row = 0; row < springs.length; row++) {
    if (!Number.isFinite(differential[row])) continue;
    const best = least.get(springs[row]);
    if (best === undefined || differential[row] < differential[best]) least.set(springs[row], row);
  }
  const rows = [...least.values()].sort((a, b) => springs[b] - springs[a]);
  const front: number[] = [];
  let lowest = Number.POSITIVE_INFINITY;
  for (const row of rows) {
    if (differential[row] < lowest) {
      front.push(row);
      lowest = differential[row];
    }
  }
  return front.reverse();
}

/** Generation, from 1, and number of the individual in a row. */
export function placeOf(
  { population }: Individuals,
  row: number,
): { generation: number; individual: number } {
  return { generation: Math.floor(row / population) + 1, individual: row % population };
}
