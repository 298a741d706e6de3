// Pull: a click selects; a node that is dragged pulls the net, an anchor that is dragged stays there.
import * as THREE from "three";
import { positionOf } from "../document/motion";
import { clicked, NOTHING, springKey } from "../document/selection";
import { ask, select, store, tell } from "../document/store";
import type { Hit } from "../viewport/picking";
import type { Viewport } from "../viewport/scene";
import type { Pointer, Tool } from "./tool";

/** A node in the hand. */
interface Held {
  key: string;
  /** Name of the anchor; null for a free node. */
  anchor: string | null;
  start: THREE.Vector3;
  /** Where on the canvas it was taken, against where it is drawn [px]. */
  offset: [number, number];
  at: THREE.Vector3;
  moved: boolean;
}

export class Pulling implements Tool {
  readonly reach = { nodes: true, springs: true, cells: true };
  readonly cursor = "default";
  private held: Held | null = null;

  down(viewport: Viewport, hit: Hit | null, pointer: Pointer): boolean {
    const { net, motion, live } = store.getState();
    if (hit?.kind !== "node" || !net || !motion) return false;
    const place = positionOf(motion, hit.row);
    const seen = viewport.project(place) ?? [pointer.x, pointer.y];
    const number = net.anchors.indexOf(hit.row);
    // While the net evolves it can only be pulled by its anchors.
    if (number < 0 && (live?.status ?? "none") !== "none") return false;
    this.held = {
      key: net.nodes[hit.row],
      anchor: number < 0 ? null : net.anchorNames[number],
      start: new THREE.Vector3(...place),
      offset: [seen[0] - pointer.x, seen[1] - pointer.y],
      at: new THREE.Vector3(...place),
      moved: false,
    };
    return true;
  }

  drag(viewport: Viewport, _: Hit | null, pointer: Pointer): void {
    const held = this.held;
    if (!held) return;
    const place = placeOf(viewport, held, pointer);
    if (!place) return;
    held.at.copy(place);
    held.moved = true;
    tell({ type: "hold", node: held.key, position: place.toArray() });
  }

  drop(): void {
    const held = this.held;
    this.held = null;
    if (!held?.moved) return;
    if (held.anchor === null) {
      tell({ type: "release" });
      return;
    }
    const position = held.at.toArray().map((value) => Math.round(value * 1e6) / 1e6);
    ask({ type: "move_anchor", anchor: held.anchor, position }, "Moving the anchor").finally(() =>
      tell({ type: "release" }),
    );
  }

  click(_: Viewport, hit: Hit | null, pointer: Pointer): void {
    const { net, selection } = store.getState();
    this.held = null;
    if (!net || !hit) {
      if (!pointer.shift) select(NOTHING);
      return;
    }
    const kind = hit.kind === "node" ? "nodes" : hit.kind === "spring" ? "springs" : "cells";
    const key =
      hit.kind === "node"
        ? net.nodes[hit.row]
        : hit.kind === "spring"
          ? springKey(net, hit.row)
          : net.addresses[hit.row];
    select(clicked(selection, kind, key, pointer.shift || pointer.control));
  }

  hover(): void {}

  cancel(): void {
    if (this.held) tell({ type: "release" });
    this.held = null;
  }
}

/** Where the pointer takes a node: along the screen, with Shift up and down only, with Ctrl level. */
function placeOf(viewport: Viewport, held: Held, pointer: Pointer): THREE.Vector3 | null {
  const ray = viewport.ray(pointer.x + held.offset[0], pointer.y + held.offset[1]);
  const forward = viewport.eye.camera.getWorldDirection(new THREE.Vector3());
  const { start } = held;
  const normal = forward.clone();
  if (pointer.shift) normal.setZ(0);
  if (pointer.control) normal.set(0, 0, 1);
  if (normal.lengthSq() < 1e-9) normal.set(0, 1, 0);
  const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(normal.normalize(), start);
  const place = ray.intersectPlane(plane, new THREE.Vector3());
  if (!place) return null;
  if (pointer.shift) place.set(start.x, start.y, place.z);
  // Near the horizon the plane is met far away.
  return place.distanceTo(start) < 20 * viewport.eye.radius ? place : null;
}
