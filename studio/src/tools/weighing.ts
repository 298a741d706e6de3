// Brush of evolution: every cell that the pointer passes is given a factor, while the net goes on evolving.
import { ask, store } from "../document/store";
import type { Hit } from "../viewport/picking";
import type { Viewport } from "../viewport/scene";
import { isBesideCell } from "./nearness";
import type { Pointer, Tool } from "./tool";

export class Weighing implements Tool {
  readonly reach = { cells: true };
  readonly cursor = "crosshair";
  /** Cells of this stroke, so that each is asked for once. */
  private readonly stroke = new Set<string>();

  down(viewport: Viewport, hit: Hit | null, pointer: Pointer): boolean {
    this.stroke.clear();
    if (hit?.kind === "cell") this.add(hit);
    return hit?.kind === "cell" || isBesideCell(viewport, pointer);
  }

  drag(_: Viewport, hit: Hit | null): void {
    if (hit?.kind === "cell") this.add(hit);
  }

  drop(): void {
    this.stroke.clear();
  }

  click(): void {
    this.stroke.clear();
  }

  hover(): void {}

  cancel(): void {
    this.stroke.clear();
  }

  private add(hit: Hit): void {
    const { net, brush, live } = store.getState();
    const cell = net?.addresses[hit.row];
    if (!cell || this.stroke.has(cell)) return;
    this.stroke.add(cell);
    const weights = Object.keys(live?.weights ?? {});
    // What is taken away from a cell may stand at one above it.
    const cells =
      brush === null ? weights.filter((one) => `${cell}.`.startsWith(`${one}.`)) : [cell];
    if (cells.length) ask({ type: "weigh_cells", cells, factor: brush }, "Brushing");
  }
}
