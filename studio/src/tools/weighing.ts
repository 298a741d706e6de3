// Brush of evolution: every cell that the pointer passes is given a factor, while the net goes on evolving.
import { ask, store } from "../document/store";
import type { Hit } from "../viewport/picking";
import type { Viewport } from "../viewport/scene";
import { beginsStroke, cellsUnderBrush } from "./brush";
import type { Pointer, Tool } from "./tool";

export class Weighing implements Tool {
  readonly reach = { cells: true };
  readonly cursor = "crosshair";
  readonly brushes = true;
  /** Cells of this stroke, so that each is asked for once. */
  private readonly stroke = new Set<string>();

  down(viewport: Viewport, _: Hit | null, pointer: Pointer): boolean {
    this.stroke.clear();
    this.add(viewport, pointer);
    return beginsStroke(viewport, pointer);
  }

  drag(viewport: Viewport, _: Hit | null, pointer: Pointer): void {
    this.add(viewport, pointer);
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

  private add(viewport: Viewport, pointer: Pointer): void {
    const { net, brush, live } = store.getState();
    if (!net) return;
    const passed = cellsUnderBrush(viewport, pointer).map((row) => net.addresses[row]);
    const fresh = passed.filter((cell) => !this.stroke.has(cell));
    for (const cell of fresh) this.stroke.add(cell);
    const weights = Object.keys(live?.weights ?? {});
    // What is taken away from a cell may stand at one above it.
    const held = (one: string) => fresh.some((cell) => `${cell}.`.startsWith(`${one}.`));
    const cells = brush === null ? weights.filter(held) : fresh;
    if (cells.length) ask({ type: "weigh_cells", cells, factor: brush }, "Brushing");
  }
}
