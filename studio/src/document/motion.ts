// Where the net is now, and what its springs carry.
import type { Arrays } from "../protocol/frames";
import type { MotionHeader } from "../protocol/messages";

/** A state of motion; nothing in it changes. */
export interface Motion {
  header: MotionHeader;
  /** (3 n) [m]. */
  positions: Float32Array;
  /** (m) [N], tension positive. */
  forces: Float32Array;
  /** What holds the anchors, (3 a) [N]. */
  reactions: Float32Array;
}

export function motionOf(header: MotionHeader, arrays: Arrays): Motion {
  return {
    header,
    positions: arrays.floats("positions"),
    forces: arrays.floats("forces"),
    reactions: arrays.floats("reactions"),
  };
}

/** Position of a node [m]. */
export function positionOf(motion: Motion, node: number): [number, number, number] {
  const { positions } = motion;
  return [positions[3 * node], positions[3 * node + 1], positions[3 * node + 2]];
}
