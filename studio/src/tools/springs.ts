// Cut takes away the spring that is clicked; Add ties one between two nodes that are clicked in turn.
import * as THREE from "three";
import { grafting } from "../document/grafting";
import { positionOf } from "../document/motion";
import { rowsByKey, springKey } from "../document/selection";
import { ask, store } from "../document/store";
import { inTurn } from "../document/turns";
import type { Hit } from "../viewport/picking";
import type { Viewport } from "../viewport/scene";
import type { Pointer, Tool } from "./tool";

export class Cutting implements Tool {
  readonly reach = { springs: true };
  readonly cursor = "crosshair";

  down(): boolean {
    return false;
  }

  drag(): void {}
  drop(): void {}
  hover(): void {}
  cancel(): void {}

  click(_: Viewport, hit: Hit | null): void {
    const { net } = store.getState();
    if (hit?.kind !== "spring" || !net) return;
    const spring = springKey(net, hit.row);
    inTurn(() => {
      const { net } = store.getState();
      if (!net || !rowsByKey(net, "springs").has(spring)) return;
      const nodes = spring.split(" ");
      ask({ type: "edit_spring", what: "cut", nodes, orbit: grafting.getState().lock }, "Cutting");
    });
  }
}

export class Adding implements Tool {
  readonly reach = { nodes: true };
  readonly cursor = "crosshair";
  private first: string | null = null;

  down(): boolean {
    return false;
  }

  drag(): void {}
  drop(): void {}

  click(viewport: Viewport, hit: Hit | null): void {
    const { net } = store.getState();
    if (hit?.kind !== "node" || !net) {
      this.cancel(viewport);
      return;
    }
    const key = net.nodes[hit.row];
    if (this.first === null || this.first === key) {
      this.first = this.first === key ? null : key;
      if (this.first === null) this.cancel(viewport);
      return;
    }
    const nodes = [this.first, key];
    ask(
      { type: "edit_spring", what: "add", nodes, orbit: grafting.getState().lock },
      "Adding a spring",
    );
    this.cancel(viewport);
  }

  hover(viewport: Viewport, hit: Hit | null, pointer: Pointer): void {
    const { net, motion } = store.getState();
    const row = this.first === null ? -1 : (net?.nodes.indexOf(this.first) ?? -1);
    if (!motion || row < 0) {
      if (viewport.rubber) this.cancel(viewport);
      return;
    }
    const from = positionOf(motion, row);
    viewport.rubber = {
      from,
      to: hit ? positionOf(motion, hit.row) : across(viewport, from, pointer),
    };
    viewport.redraw(true);
  }

  cancel(viewport: Viewport): void {
    this.first = null;
    viewport.rubber = null;
    viewport.redraw(true);
  }
}

/** The place under the pointer as far away as a place. */
function across(
  viewport: Viewport,
  place: [number, number, number],
  pointer: Pointer,
): [number, number, number] {
  const forward = viewport.eye.camera.getWorldDirection(new THREE.Vector3());
  const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(
    forward,
    new THREE.Vector3(...place),
  );
  return (viewport
    .ray(pointer.x, pointer.y)
    .intersectPlane(plane, new THREE.Vector3())
    ?.toArray() ?? place) as [number, number, number];
}
