// Figures of the net as it is seen, which is not always at rest.
import type { Motion } from "./motion";
import type { Net } from "./net";
import { lengthsOf } from "./quantities";

/** Measures of a net where it is now; forces in N, lengths in m. */
export interface FiguresNow {
  springs: number;
  force_differential: number | null;
  force_max: number;
  force_min: number;
  force_mean: number;
  total_length: number;
  shortest_spring: number;
}

const VANISHING = 1e-12; // share of the largest force, as the engine has it

/** Measures a net where it is; null if it has no springs. */
export function figuresNow(net: Net, motion: Motion): FiguresNow | null {
  const springs = motion.forces.length;
  if (!springs) return null;
  const lengths = lengthsOf(net, motion);
  const sum = (values: Float32Array) => values.reduce((all, value) => all + value, 0);
  const least = (values: Float32Array) => values.reduce((a, b) => Math.min(a, b));
  const [low, high] = [least(motion.forces), motion.forces.reduce((a, b) => Math.max(a, b))];
  return {
    springs,
    force_differential: low > 0 && low >= VANISHING * high ? high / low : null,
    force_max: high,
    force_min: low,
    force_mean: sum(motion.forces) / springs,
    total_length: sum(lengths),
    shortest_spring: least(lengths),
  };
}

type Compared = Pick<FiguresNow, "springs" | "force_differential">;

/** Rise of the force differential for every spring that came, as the engine has it for runs; null if none came. */
export function springUtilization(now: Compared, before: Compared): number | null {
  const gained = now.springs - before.springs;
  if (gained <= 0 || now.force_differential === null || before.force_differential === null)
    return null;
  return (now.force_differential - before.force_differential) / gained;
}

/** Whether more force differential is worse: that which comes with more springs is what they cost. */
export function differentialTells(now: Compared, before: Compared | null): boolean {
  return before === null || !((springUtilization(now, before) ?? 0) > 0);
}
