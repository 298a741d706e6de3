// Brush: every cell that the pointer passes is subdivided when the button comes up.
import { grafting } from "../document/grafting";
import { ask, store } from "../document/store";
import type { Hit } from "../viewport/picking";
import type { Viewport } from "../viewport/scene";
import type { Pointer, Tool } from "./tool";

export class Brushing implements Tool {
  readonly reach = { cells: true };
  readonly cursor = "crosshair";

  down(viewport: Viewport, hit: Hit | null): boolean {
    if (hit?.kind !== "cell") return false;
    this.add(viewport, hit);
    return true;
  }

  drag(viewport: Viewport, hit: Hit | null): void {
    if (hit?.kind === "cell") this.add(viewport, hit);
  }

  drop(viewport: Viewport): void {
    this.subdivide(viewport);
  }

  click(viewport: Viewport, _: Hit | null, __: Pointer): void {
    this.subdivide(viewport);
  }

  hover(): void {}

  cancel(viewport: Viewport): void {
    viewport.brushed = new Set();
    viewport.redraw(true);
  }

  private add(viewport: Viewport, hit: Hit): void {
    viewport.brushed.add(hit.row);
    viewport.redraw(true);
  }

  private subdivide(viewport: Viewport): void {
    const { net } = store.getState();
    const cells = net ? [...viewport.brushed].map((row) => net.addresses[row]) : [];
    this.cancel(viewport);
    if (!cells.length) return;
    ask(
      { type: "edit_cells", what: "subdivide", cells, kind: null, orbit: grafting.getState().lock },
      "Subdividing",
    );
  }
}
