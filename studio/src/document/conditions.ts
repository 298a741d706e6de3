// Springs that carry nothing, and the form that tells them from others whatever they are coloured by.
import type { Motion } from "./motion";
import type { Lines } from "./section";

/** What a spring does. */
export type Condition = "carries" | "slack" | "broken";

const CONDITIONS: Condition[] = ["carries", "slack", "broken"];

/** A force below this share of the largest counts as none. */
const SLACK_SHARE = 1e-9;

/** Which parts of a spring are drawn, as shares of its length: slack ones are dashed, broken ones gape. */
export const PIECES: Record<Condition, [from: number, to: number][]> = {
  carries: [[0, 1]],
  slack: [
    [0, 0.14],
    [0.29, 0.43],
    [0.57, 0.71],
    [0.86, 1],
  ],
  broken: [
    [0, 0.3],
    [0.7, 1],
  ],
};

/** Width of springs that carry nothing over that of others. */
const THIN = 0.65;

/** Conditions of all springs by number, and how many there are of each. */
export interface Conditions {
  numbers: Uint8Array;
  slack: number;
  broken: number;
}

export function conditionsOf({ forces }: Motion): Conditions {
  let largest = 0;
  for (const force of forces)
    if (Number.isFinite(force)) largest = Math.max(largest, Math.abs(force));
  const found = { numbers: new Uint8Array(forces.length), slack: 0, broken: 0 };
  for (let spring = 0; spring < forces.length; spring++) {
    const condition = !Number.isFinite(forces[spring])
      ? "broken"
      : Math.abs(forces[spring]) <= SLACK_SHARE * largest
        ? "slack"
        : "carries";
    if (condition === "carries") continue;
    found.numbers[spring] = CONDITIONS.indexOf(condition);
    found[condition]++;
  }
  return found;
}

/** The condition of a spring. */
export function conditionOf(conditions: Conditions, spring: number): Condition {
  return CONDITIONS[conditions.numbers[spring]];
}

/** Springs as lines in the form that tells their condition; one line a spring comes in. */
export function formed(lines: Lines, conditions: Conditions): Lines {
  if (!conditions.slack && !conditions.broken) return lines;
  const more =
    conditions.slack * (PIECES.slack.length - 1) + conditions.broken * (PIECES.broken.length - 1);
  const size = lines.count + more;
  const ends = new Float32Array(6 * size);
  const colours = new Uint8Array(3 * size);
  const widths = new Float32Array(size);
  let count = 0;
  for (let line = 0; line < lines.count; line++) {
    const condition = conditionOf(conditions, line);
    const width = typeof lines.widths === "number" ? lines.widths : lines.widths[line];
    const from = 6 * line;
    for (const piece of PIECES[condition]) {
      piece.forEach((share, end) => {
        for (let axis = 0; axis < 3; axis++) {
          const start = lines.ends[from + axis];
          ends[6 * count + 3 * end + axis] = start + share * (lines.ends[from + 3 + axis] - start);
        }
      });
      colours.set(lines.colours.subarray(3 * line, 3 * line + 3), 3 * count);
      widths[count++] = condition === "carries" ? width : THIN * width;
    }
  }
  return { count, ends, colours, widths };
}
