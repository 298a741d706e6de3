// Brush: every cell that the pointer passes is subdivided, or given a type, when the button comes up.
import { grafting } from "../document/grafting";
import { ask, store } from "../document/store";
import type { Hit } from "../viewport/picking";
import type { Viewport } from "../viewport/scene";
import { isBesideCell } from "./nearness";
import type { Pointer, Tool } from "./tool";

export class Brushing implements Tool {
  readonly reach = { cells: true };
  readonly cursor = "crosshair";

  constructor(private readonly what: "subdivide" | "retype") {}

  down(viewport: Viewport, hit: Hit | null, pointer: Pointer): boolean {
    if (hit?.kind === "cell") this.add(viewport, hit);
    return hit?.kind === "cell" || isBesideCell(viewport, pointer);
  }

  drag(viewport: Viewport, hit: Hit | null): void {
    if (hit?.kind === "cell") this.add(viewport, hit);
  }

  drop(viewport: Viewport): void {
    this.finish(viewport);
  }

  click(viewport: Viewport, _: Hit | null, __: Pointer): void {
    this.finish(viewport);
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

  private finish(viewport: Viewport): void {
    const { net, brushType } = store.getState();
    const cells = net ? [...viewport.brushed].map((row) => net.addresses[row]) : [];
    this.cancel(viewport);
    if (!cells.length) return;
    const kind = this.what === "retype" ? brushType : null;
    const label = this.what === "retype" ? "Changing types" : "Subdividing";
    const orbit = grafting.getState().lock;
    ask({ type: "edit_cells", what: this.what, cells, kind, orbit }, label);
  }
}
