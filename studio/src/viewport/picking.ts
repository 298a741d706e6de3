// What lies under the pointer, found in pixels: nodes before springs before cells, the nearest to the eye.
import * as THREE from "three";
import type { Motion } from "../document/motion";
import { groupOf, type Net } from "../document/net";
import { type Cut, keeps } from "../document/section";

/** What was hit, by its row. */
export interface Hit {
  kind: "node" | "spring" | "cell";
  row: number;
}

const NODE_REACH = 8; // px
const SPRING_REACH = 6; // px

/** Nodes on the canvas: x, y [px] and depth, three numbers each; depth above 1 is behind the eye. */
export class Projection {
  readonly places: Float32Array;

  constructor(
    motion: Motion,
    camera: THREE.Camera,
    width: number,
    height: number,
    cut: Cut | null = null,
  ) {
    const matrix = new THREE.Matrix4().multiplyMatrices(
      camera.projectionMatrix,
      camera.matrixWorldInverse,
    );
    const m = matrix.elements;
    const { positions } = motion;
    this.places = new Float32Array(positions.length);
    for (let at = 0; at < positions.length; at += 3) {
      const x = positions[at];
      const y = positions[at + 1];
      const z = positions[at + 2];
      const w = m[3] * x + m[7] * y + m[11] * z + m[15];
      // What a section takes away can't be seen, as if it were behind the eye.
      const front = w > 1e-9 && keeps(cut, positions, at / 3);
      this.places[at] = front
        ? ((m[0] * x + m[4] * y + m[8] * z + m[12]) / w + 1) * 0.5 * width
        : -1e6;
      this.places[at + 1] = front
        ? (1 - (m[1] * x + m[5] * y + m[9] * z + m[13]) / w) * 0.5 * height
        : -1e6;
      this.places[at + 2] = front ? (m[2] * x + m[6] * y + m[10] * z + m[14]) / w : 2;
    }
  }
}

/** What lies at a point of the canvas [px]; `kinds` says what is looked for. */
export function pick(
  net: Net,
  { places }: Projection,
  x: number,
  y: number,
  kinds: { nodes?: boolean; springs?: boolean; cells?: boolean },
): Hit | null {
  if (kinds.nodes) {
    const row = nearestNode(places, x, y, NODE_REACH);
    if (row >= 0) return { kind: "node", row };
  }
  if (kinds.springs) {
    const row = nearestSpring(net, places, x, y);
    if (row >= 0) return { kind: "spring", row };
  }
  if (kinds.cells) {
    const row = frontCell(net, places, x, y);
    if (row >= 0) return { kind: "cell", row };
  }
  return null;
}

/** Pixels count, and so does depth: of two nodes within reach, the one in front is meant. */
function nearestNode(places: Float32Array, x: number, y: number, reach: number): number {
  let best = -1;
  let least = reach;
  for (let node = 0; 3 * node < places.length; node++) {
    const distance = Math.hypot(places[3 * node] - x, places[3 * node + 1] - y);
    if (distance > reach) continue;
    const cost = distance + 40 * Math.max(0, places[3 * node + 2]) ** 8;
    if (best < 0 || cost < least) {
      best = node;
      least = cost;
    }
  }
  return best;
}

function nearestSpring(net: Net, places: Float32Array, x: number, y: number): number {
  let best = -1;
  let least = SPRING_REACH;
  for (let spring = 0; 2 * spring < net.ends.length; spring++) {
    const a = 3 * net.ends[2 * spring];
    const b = 3 * net.ends[2 * spring + 1];
    if (places[a + 2] > 1 || places[b + 2] > 1) continue;
    const dx = places[b] - places[a];
    const dy = places[b + 1] - places[a + 1];
    const px = x - places[a];
    const py = y - places[a + 1];
    const square = dx * dx + dy * dy;
    const share = square > 0 ? Math.min(1, Math.max(0, (px * dx + py * dy) / square)) : 0;
    const distance = Math.hypot(px - share * dx, py - share * dy);
    if (distance < least) {
      best = spring;
      least = distance;
    }
  }
  return best;
}

function frontCell(net: Net, places: Float32Array, x: number, y: number): number {
  let best = -1;
  let front = 1;
  for (let cell = 0; cell < net.addresses.length; cell++) {
    const around = groupOf(net.boundaries, cell);
    let inside = false;
    let depth = 0;
    for (let corner = 0; corner < around.length; corner++) {
      const a = 3 * around[corner];
      const b = 3 * around[(corner + 1) % around.length];
      depth += places[a + 2] / around.length;
      const [ax, ay, bx, by] = [places[a], places[a + 1], places[b], places[b + 1]];
      if (ay > y !== by > y && x < ((bx - ax) * (y - ay)) / (by - ay) + ax) inside = !inside;
    }
    if (inside && depth < front) {
      best = cell;
      front = depth;
    }
  }
  return best;
}
