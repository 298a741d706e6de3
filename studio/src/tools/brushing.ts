// Brush: every cell that the pointer passes is subdivided, or given a type, when the button comes up.
import { grafting } from "../document/grafting";
import { rowsByKey } from "../document/selection";
import { ask, store } from "../document/store";
import { inTurn } from "../document/turns";
import type { Hit } from "../viewport/picking";
import type { Viewport } from "../viewport/scene";
import { beginsStroke, cellsUnderBrush } from "./brush";
import type { Pointer, Tool } from "./tool";

export class Brushing implements Tool {
  readonly reach = { cells: true };
  readonly cursor = "crosshair";
  readonly brushes = true;

  constructor(private readonly what: "subdivide" | "retype") {}

  down(viewport: Viewport, _: Hit | null, pointer: Pointer): boolean {
    this.add(viewport, pointer);
    return beginsStroke(viewport, pointer);
  }

  drag(viewport: Viewport, _: Hit | null, pointer: Pointer): void {
    this.add(viewport, pointer);
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

  private add(viewport: Viewport, pointer: Pointer): void {
    for (const cell of cellsUnderBrush(viewport, pointer)) viewport.brushed.add(cell);
    viewport.redraw(true);
  }

  private finish(viewport: Viewport): void {
    const { net, brushType } = store.getState();
    const brushed = net ? [...viewport.brushed].map((row) => net.addresses[row]) : [];
    this.cancel(viewport);
    if (brushed.length)
      inTurn(() => {
        // The stroke before may have divided what this one passed while it was still seen whole.
        const { net } = store.getState();
        const cells = net ? brushed.filter((cell) => rowsByKey(net, "cells").has(cell)) : [];
        if (!cells.length) return;
        const kind = this.what === "retype" ? brushType : null;
        const label = this.what === "retype" ? "Changing types" : "Subdividing";
        const orbit = grafting.getState().lock;
        ask({ type: "edit_cells", what: this.what, cells, kind, orbit }, label);
      });
  }
}
