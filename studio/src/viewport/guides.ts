// Guides over the net: arms to drag a node along an axis, and the lines and planes on which nodes slide.
import * as THREE from "three";
import { positionOf } from "../document/motion";
import type { Colour } from "../document/palettes";
import { selectedRows } from "../document/selection";
import type { State } from "../document/store";

export type Axis = 0 | 1 | 2;

export const AXES = [
  new THREE.Vector3(1, 0, 0),
  new THREE.Vector3(0, 1, 0),
  new THREE.Vector3(0, 0, 1),
];

/** x red, y green, z blue, as everywhere. */
export const AXIS_COLOURS: Colour[] = [
  [235, 87, 87],
  [76, 195, 138],
  [91, 141, 239],
];

const ARM = 64; // px
const REACH = 7; // px
const INNER = 12; // px, where the node itself is taken

/** Directions along which something may move, drawn through a place. */
export interface Guide {
  at: THREE.Vector3;
  along: THREE.Vector3[];
  colour: Colour;
}

/** Lines with colours and a width. */
export interface GuideLines {
  ends: number[];
  colours: number[];
  widths: number[];
}

/** The node whose arms are shown: the one that is selected, while nothing else is in the hand. */
export function armedNode({ net, motion, selection, tool }: State): number | null {
  if (!net || !motion || tool !== "pull") return null;
  const rows = selectedRows(net, selection, "nodes");
  return rows.length === 1 ? rows[0] : null;
}

/** Length of an arm at a place [m]. */
export function armLength(
  camera: THREE.PerspectiveCamera,
  place: THREE.Vector3,
  height: number,
): number {
  const depth = place.clone().applyMatrix4(camera.matrixWorldInverse).z;
  return (2 * Math.abs(depth) * Math.tan(THREE.MathUtils.degToRad(camera.fov / 2)) * ARM) / height;
}

/** The arm under a point of the canvas [px], if there is one. */
export function armUnder(
  project: (place: [number, number, number]) => [number, number] | null,
  place: THREE.Vector3,
  length: number,
  x: number,
  y: number,
): Axis | null {
  const from = project(place.toArray());
  if (!from || Math.hypot(x - from[0], y - from[1]) < INNER) return null;
  let best: Axis | null = null;
  let least = REACH;
  for (const axis of [0, 1, 2] as const) {
    const to = project(place.clone().addScaledVector(AXES[axis], length).toArray());
    if (!to) continue;
    const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    const square = dx * dx + dy * dy;
    if (square < INNER * INNER) continue;
    const share = Math.min(1, ((x - from[0]) * dx + (y - from[1]) * dy) / square);
    const distance = Math.hypot(x - from[0] - share * dx, y - from[1] - share * dy);
    if (share > 0 && distance < least) {
      best = axis;
      least = distance;
    }
  }
  return best;
}

/** All guides of a state as lines. */
export function guideLines(
  state: State,
  camera: THREE.PerspectiveCamera,
  height: number,
  radius: number,
  dragged: Guide | null,
  slide: Colour,
): GuideLines {
  const lines: GuideLines = { ends: [], colours: [], widths: [] };
  const add = (from: THREE.Vector3, to: THREE.Vector3, colour: Colour, width: number) => {
    lines.ends.push(...from, ...to);
    lines.colours.push(...colour);
    lines.widths.push(width);
  };
  const through = (guide: Guide, size: number, width: number) => {
    for (const along of guide.along) {
      const half = along.clone().normalize().multiplyScalar(size);
      add(guide.at.clone().sub(half), guide.at.clone().add(half), guide.colour, width);
    }
  };
  const { net, motion, document, view } = state;
  if (!net || !motion) return lines;
  if (dragged) through(dragged, 3 * radius, 1.2);
  for (const anchor of view.anchors ? (document?.anchors ?? []) : []) {
    const along = freeDirections(anchor);
    const number = net.anchorNames.indexOf(anchor.name);
    if (!along.length || number < 0) continue;
    const at = new THREE.Vector3(...positionOf(motion, net.anchors[number]));
    through({ at, along, colour: slide }, 0.09 * radius, 2);
  }
  const node = armedNode(state);
  if (node !== null && !dragged) {
    const at = new THREE.Vector3(...positionOf(motion, node));
    const length = armLength(camera, at, height);
    const eye = camera.position;
    AXES.forEach((axis, number) => {
      const tip = at.clone().addScaledVector(axis, length);
      const side = axis.clone().cross(eye.clone().sub(tip)).normalize();
      const back = tip.clone().addScaledVector(axis, -0.2 * length);
      add(at, tip, AXIS_COLOURS[number], 2.6);
      for (const sign of [1, -1])
        add(
          tip,
          back.clone().addScaledVector(side, 0.09 * sign * length),
          AXIS_COLOURS[number],
          2.6,
        );
    });
  }
  return lines;
}

type Support = NonNullable<State["document"]>["anchors"][number];

/** Directions in which an anchor is free: none if it is fixed. */
function freeDirections({ holds, line, plane }: Support): THREE.Vector3[] {
  if (line) return [new THREE.Vector3(...line)];
  if (plane) {
    const normal = new THREE.Vector3(...plane).normalize();
    const first = normal.clone().cross(Math.abs(normal.z) < 0.9 ? AXES[2] : AXES[0]);
    return [first, normal.clone().cross(first)];
  }
  return AXES.filter((_, axis) => !holds.includes("xyz"[axis]));
}
