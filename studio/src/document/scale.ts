// From numbers to colours: the range of a scale, linear or logarithmic, and its ticks.

export type RangeMode = "full" | "percentile" | "fixed";

/** A range of values that colours run over. */
export interface Scale {
  low: number;
  high: number;
  logarithmic: boolean;
}

/** How a scale is chosen. */
export interface ScaleChoice {
  mode: RangeMode;
  logarithmic: boolean;
  /** Ends of the scale when `mode` is fixed. */
  fixed: [low: number, high: number];
}

/** Share of the values that lies outside a percentile range, at each end. */
export const TAIL = 0.05;

/** Decades that a logarithmic scale shows at most. */
const DECADES = 4;

/** The scale for values; those that are not finite do not count. */
export function scaleOf(values: Float32Array, choice: ScaleChoice): Scale {
  const finite = values.filter(Number.isFinite);
  let low = Number.POSITIVE_INFINITY;
  let high = Number.NEGATIVE_INFINITY;
  if (choice.mode === "fixed") {
    [low, high] = choice.fixed;
  } else if (choice.mode === "percentile" && finite.length) {
    finite.sort();
    low = finite[Math.floor(TAIL * (finite.length - 1))];
    high = finite[Math.ceil((1 - TAIL) * (finite.length - 1))];
  } else {
    for (const value of finite) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (!(low <= high)) [low, high] = [0, 1];
  const logarithmic = choice.logarithmic && high > 0;
  if (logarithmic) low = Math.max(low, high * 10 ** -DECADES);
  return { low, high, logarithmic };
}

/** Where a value lies on a scale, 0 to 1. */
export function placeOn({ low, high, logarithmic }: Scale, value: number): number {
  if (!(high > low)) return 0.5;
  const share = logarithmic
    ? value > 0
      ? Math.log(value / low) / Math.log(high / low)
      : 0
    : (value - low) / (high - low);
  return Math.min(1, Math.max(0, share));
}

/** The value at a place of a scale, 0 to 1. */
export function valueAt({ low, high, logarithmic }: Scale, place: number): number {
  return logarithmic ? low * (high / low) ** place : low + (high - low) * place;
}

/** A number in a few digits, for people. */
export function inDigits(value: number | null | undefined, digits = 3): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e5)) {
    return value
      .toExponential(digits - 1)
      .replace("e+", "e")
      .replace("-", "−")
      .replace("e-", "e−");
  }
  const text = Number(value.toPrecision(digits)).toLocaleString("en", { maximumFractionDigits: 6 });
  return text.replace("-", "−");
}

/** A count for people, written out however large it is. */
export function inFull(count: number | null | undefined): string {
  return count === null || count === undefined ? "–" : count.toLocaleString("en");
}

/** How far a value went from another, as finely as the value is shown in so many digits; null if that is less. */
export function changeInDigits(value: number, before: number, digits: number): string | null {
  const change = Math.abs(value - before);
  const size = Math.max(Math.abs(value), Math.abs(before));
  const finest = Math.floor(Math.log10(size)) - digits + 1;
  if (!(change >= 10 ** finest)) return null;
  const plain = size >= 1e-3 && size < 1e5;
  const said = plain
    ? Number(change.toPrecision(3)).toLocaleString("en", {
        maximumFractionDigits: Math.max(0, -finest),
      })
    : inDigits(change);
  return `${value > before ? "+" : "−"}${said}`;
}
