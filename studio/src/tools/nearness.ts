// Whether a stroke begins beside the net rather than far from it, where a drag turns the eye.
import type { Viewport } from "../viewport/scene";
import type { Pointer } from "./tool";

const NEAR = [20, 40]; // px
const DIRECTIONS = 24;

/** Whether cells lie within a finger's breadth of the pointer. */
export function isBesideCell(viewport: Viewport, { x, y }: Pointer): boolean {
  return NEAR.some((radius) =>
    Array.from({ length: DIRECTIONS }, (_, step) => (2 * Math.PI * step) / DIRECTIONS).some(
      (angle) =>
        viewport.pick(x + radius * Math.cos(angle), y + radius * Math.sin(angle), {
          cells: true,
        }) !== null,
    ),
  );
}
