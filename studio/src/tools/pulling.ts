// Pull: a click selects; a node that is dragged pulls the net, an anchor that is dragged stays there.
import * as THREE from "three";
import { isEvolving, notEditable } from "../document/editable";
import { positionOf } from "../document/motion";
import { clicked, NOTHING, springKey } from "../document/selection";
import { ask, select, store, tell } from "../document/store";
import { AXES, AXIS_COLOURS, type Axis } from "../viewport/guides";
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
  /** The arm by which it was taken. */
  axis: Axis | null;
}

export class Pulling implements Tool {
  readonly reach = { nodes: true, springs: true, cells: true };
  readonly cursor = "default";
  readonly direct = true;
  private held: Held | null = null;

  down(viewport: Viewport, hit: Hit | null, pointer: Pointer): boolean {
    const state = store.getState();
    const { net, motion } = state;
    const arm = viewport.armUnder(pointer.x, pointer.y);
    const node = arm?.node ?? (hit?.kind === "node" ? hit.row : null);
    if (node === null || !net || !motion) return false;
    const place = positionOf(motion, node);
    const seen = viewport.project(place) ?? [pointer.x, pointer.y];
    const number = net.anchors.indexOf(node);
    // While the net evolves it can only be pulled by its anchors, and what is looked at only by other nodes.
    if (notEditable(state) !== null && number < 0 === isEvolving(state)) return false;
    this.held = {
      axis: arm?.axis ?? null,
      key: net.nodes[node],
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
    viewport.guide = guideOf(held, pointer);
    viewport.redraw(true);
    if (held.moved && place.equals(held.at)) return;
    held.at.copy(place);
    held.moved = true;
    tell({ type: "hold", node: held.key, position: place.toArray() });
  }

  drop(viewport: Viewport): void {
    const held = this.held;
    this.held = null;
    viewport.guide = null;
    viewport.redraw(true);
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
    const byArm = this.held?.axis != null;
    this.held = null;
    if (byArm) return;
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

  hover(viewport: Viewport, _: Hit | null, { x, y }: Pointer): void {
    viewport.point(viewport.armUnder(x, y) ? "move" : this.cursor);
  }

  cancel(viewport: Viewport): void {
    if (this.held) tell({ type: "release" });
    this.held = null;
    viewport.guide = null;
    viewport.redraw(true);
  }
}

/** Where the pointer takes a node: along the screen, with Shift up and down only, with Ctrl level. */
function placeOf(viewport: Viewport, held: Held, pointer: Pointer): THREE.Vector3 | null {
  const ray = viewport.ray(pointer.x + held.offset[0], pointer.y + held.offset[1]);
  const forward = viewport.eye.camera.getWorldDirection(new THREE.Vector3());
  const { start, axis } = held;
  if (axis !== null) return alongAxis(ray, start, AXES[axis]);
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

/** The place on an axis through `start` that is nearest to a ray; null where both run alike. */
function alongAxis(
  ray: THREE.Ray,
  start: THREE.Vector3,
  axis: THREE.Vector3,
): THREE.Vector3 | null {
  const across = ray.direction.dot(axis);
  const spread = 1 - across * across;
  if (spread < 1e-4) return null;
  const between = ray.origin.clone().sub(start);
  const along = (between.dot(axis) - across * between.dot(ray.direction)) / spread;
  return start.clone().addScaledVector(axis, along);
}

/** Lines along which what is held moves now. */
function guideOf({ start, axis }: Held, { shift, control }: Pointer) {
  const colour = AXIS_COLOURS[axis ?? 2];
  if (axis !== null) return { at: start, along: [AXES[axis]], colour };
  if (shift) return { at: start, along: [AXES[2]], colour };
  if (control) return { at: start, along: [AXES[0], AXES[1]], colour };
  return null;
}
