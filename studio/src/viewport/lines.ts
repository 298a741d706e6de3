// The springs of a net as lines: where they end, and how wide they are.
import type { ColourChoice } from "../document/colouring";
import type { Motion } from "../document/motion";
import type { Net } from "../document/net";
import { quantityOf } from "../document/quantities";
import { placeOn, scaleOf } from "../document/scale";

/** Widths of springs [px]. */
export const WIDTH = 1.6;
const THINNEST = 0.7;
const THICKEST = 5;

/** Springs that a software rasteriser draws as ribbons once nothing moves. */
export const STILL_RIBBONS = 12_000;

/** Six coordinates a spring [m]. */
export function endsOf(net: Net, positions: Float32Array): Float32Array {
  const ends = new Float32Array(3 * net.ends.length);
  for (let end = 0; end < net.ends.length; end++) {
    const node = 3 * net.ends[end];
    ends[3 * end] = positions[node];
    ends[3 * end + 1] = positions[node + 1];
    ends[3 * end + 2] = positions[node + 2];
  }
  return ends;
}

/** Widths by what springs are coloured by; by force where that is no number. */
export function widthsOf(net: Net, motion: Motion, by: ColourChoice): Float32Array {
  const values = (quantityOf(by.by) ?? quantityOf("force")!).values(net, motion);
  const scale = scaleOf(values, by);
  return values.map((value) =>
    Number.isFinite(value) ? THINNEST + (THICKEST - THINNEST) * placeOn(scale, value) : THINNEST,
  );
}
