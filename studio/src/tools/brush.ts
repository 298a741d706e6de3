// The brush: which cells lie under it, and whether a stroke begins beside the net rather than far from it.
import { BRUSH_RADII, store } from "../document/store";
import type { Viewport } from "../viewport/scene";
import type { Pointer } from "./tool";

const BESIDE = [20, 40]; // px beyond the brush
const DIRECTIONS = 8;
const STEP = 9; // px between the places of a brush that are looked at

/** Cells in front that a brush covers in part. */
export function cellsUnderBrush(viewport: Viewport, { x, y }: { x: number; y: number }): number[] {
  const { brushRadius } = store.getState();
  const reach = brushRadius > BRUSH_RADII[0] ? brushRadius : 0;
  const found = new Set<number>();
  const steps = Math.floor(reach / STEP);
  for (let across = -steps; across <= steps; across++)
    for (let up = -steps; up <= steps; up++) {
      const [dx, dy] = [across * STEP, up * STEP];
      if (Math.hypot(dx, dy) > reach) continue;
      const hit = viewport.pick(x + dx, y + dy, { cells: true });
      if (hit?.kind === "cell") found.add(hit.row);
    }
  return [...found];
}

/** Whether a stroke begins on cells or beside them; far from the net a drag turns the eye. */
export function beginsStroke(viewport: Viewport, pointer: Pointer): boolean {
  if (cellsUnderBrush(viewport, pointer).length) return true;
  const { x, y } = pointer;
  const { brushRadius } = store.getState();
  return BESIDE.map((beyond) => beyond + brushRadius).some((radius) =>
    Array.from({ length: DIRECTIONS }, (_, step) => (2 * Math.PI * step) / DIRECTIONS).some(
      (angle) =>
        viewport.pick(x + radius * Math.cos(angle), y + radius * Math.sin(angle), {
          cells: true,
        }) !== null,
    ),
  );
}

/** Takes the next larger or smaller brush. */
export function resizeBrush(by: 1 | -1): void {
  store.setState(({ brushRadius }) => {
    const now = BRUSH_RADII.indexOf(brushRadius);
    return { brushRadius: BRUSH_RADII[Math.min(Math.max(now + by, 0), BRUSH_RADII.length - 1)] };
  });
}
