// What lies under the pointer, found in pixels: nodes before springs before cells, the nearest to the eye.
import * as THREE from "three";
import type { Motion } from "../document/motion";
import { groupOf, type Net } from "../document/net";
import { type Cut, cutOf, keeps, type Section } from "../document/section";

/** What was hit, by its row. */
export interface Hit {
  kind: "node" | "spring" | "cell";
  row: number;
}

const NODE_REACH = 8; // px
const SPRING_REACH = 6; // px

const HIDDEN = -1e6; // px
const NEAREST = 1e-9;
const BIN = 32; // px

/** What decides where nodes are on the canvas. */
export interface Look {
  motion: Motion;
  camera: THREE.Camera;
  /** [px]. */
  width: number;
  height: number;
  section: Section | null;
}

/**
 * Nodes on the canvas: x, y [px] and depth, three numbers each. What is behind the eye or taken away by a
 * section has a depth above 1.
 */
export class Projection {
  readonly places: Float32Array;
  private readonly matrix: THREE.Matrix4;
  private readonly cut: Cut | null;
  private bins: { net: Net; cells: number[][]; across: number } | null = null;

  constructor(private readonly look: Look) {
    const { motion, section } = look;
    this.matrix = matrixOf(look.camera);
    this.cut = cutOf(section, motion.positions);
    const { positions } = motion;
    this.places = new Float32Array(positions.length);
    for (let node = 0; 3 * node < positions.length; node++) {
      const [x, y, depth] = keeps(this.cut, positions, node)
        ? this.place(positions[3 * node], positions[3 * node + 1], positions[3 * node + 2])
        : GONE;
      this.places[3 * node] = x;
      this.places[3 * node + 1] = y;
      this.places[3 * node + 2] = depth;
    }
  }

  /** Whether it is that of another look too. */
  holds({ motion, camera, width, height, section }: Look): boolean {
    const { look } = this;
    const same = motion === look.motion && section === look.section;
    const sized = width === look.width && height === look.height;
    return same && sized && this.matrix.equals(matrixOf(camera));
  }

  /** Ends on the canvas of what can be seen of a line between two nodes: x, y, x, y [px]; null: nothing. */
  seen(first: number, second: number): [number, number, number, number] | null {
    const [a, b] = [3 * first, 3 * second];
    const { positions } = this.look.motion;
    const { elements: m } = this.matrix;
    const depth = (at: number) =>
      m[3] * positions[at] + m[7] * positions[at + 1] + m[11] * positions[at + 2] + m[15];
    // How far each end is on this side of the eye, and on the kept side of the section.
    const sides = [[depth(a) - NEAREST, depth(b) - NEAREST]];
    if (this.cut) {
      const { axis, at, sign } = this.cut;
      sides.push([a, b].map((end) => -sign * (positions[end + axis] - at)));
    }
    let [from, to] = [0, 1];
    for (const [start, end] of sides) {
      if (start < 0 && end < 0) return null;
      if (start < 0) from = Math.max(from, start / (start - end));
      if (end < 0) to = Math.min(to, start / (start - end));
    }
    if (from >= to) return null;
    const along = (share: number) =>
      [0, 1, 2].map((axis) => {
        const start = positions[a + axis];
        return start + share * (positions[b + axis] - start);
      }) as [number, number, number];
    const [ax, ay] = this.place(...along(from));
    const [bx, by] = this.place(...along(to));
    return [ax, ay, bx, by];
  }

  /** Cells whose corners surround a bin of the canvas in which a point lies. */
  cellsNear(net: Net, x: number, y: number): number[] {
    if (this.bins?.net !== net) this.bins = this.binned(net);
    const { cells, across } = this.bins;
    const [column, row] = [Math.floor(x / BIN), Math.floor(y / BIN)];
    return column >= 0 && column < across ? (cells[row * across + column] ?? []) : [];
  }

  private binned(net: Net) {
    const { places } = this;
    const across = Math.ceil(this.look.width / BIN);
    const down = Math.ceil(this.look.height / BIN);
    const cells = Array.from({ length: across * down }, (): number[] => []);
    for (let cell = 0; cell < net.addresses.length; cell++) {
      let [left, right, top, bottom] = [Infinity, -Infinity, Infinity, -Infinity];
      let whole = true;
      for (const node of groupOf(net.boundaries, cell)) {
        const at = 3 * node;
        whole &&= places[at + 2] <= 1;
        left = Math.min(left, places[at]);
        right = Math.max(right, places[at]);
        top = Math.min(top, places[at + 1]);
        bottom = Math.max(bottom, places[at + 1]);
      }
      // What a section cuts through is not drawn as a cell either.
      if (!whole) continue;
      const last = Math.min(across - 1, Math.floor(right / BIN));
      for (let row = Math.max(0, Math.floor(top / BIN)); row * BIN <= bottom && row < down; row++)
        for (let column = Math.max(0, Math.floor(left / BIN)); column <= last; column++)
          cells[row * across + column].push(cell);
    }
    return { net, cells, across };
  }

  private place(x: number, y: number, z: number): readonly [number, number, number] {
    const { elements: m } = this.matrix;
    const w = m[3] * x + m[7] * y + m[11] * z + m[15];
    if (w < NEAREST) return GONE;
    return [
      ((m[0] * x + m[4] * y + m[8] * z + m[12]) / w + 1) * 0.5 * this.look.width,
      (1 - (m[1] * x + m[5] * y + m[9] * z + m[13]) / w) * 0.5 * this.look.height,
      (m[2] * x + m[6] * y + m[10] * z + m[14]) / w,
    ];
  }
}

const GONE = [HIDDEN, HIDDEN, 2] as const;

function matrixOf(camera: THREE.Camera): THREE.Matrix4 {
  return new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
}

/** What lies at a point of the canvas [px]; `kinds` says what is looked for. */
export function pick(
  net: Net,
  projection: Projection,
  x: number,
  y: number,
  kinds: { nodes?: boolean; springs?: boolean; cells?: boolean },
): Hit | null {
  if (kinds.nodes) {
    const row = nearestNode(projection.places, x, y, NODE_REACH);
    if (row >= 0) return { kind: "node", row };
  }
  if (kinds.springs) {
    const row = nearestSpring(net, projection, x, y);
    if (row >= 0) return { kind: "spring", row };
  }
  if (kinds.cells) {
    const row = frontCell(net, projection, x, y);
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

function nearestSpring(net: Net, projection: Projection, x: number, y: number): number {
  let best = -1;
  let least = SPRING_REACH;
  const { places } = projection;
  for (let spring = 0; 2 * spring < net.ends.length; spring++) {
    const [first, second] = [net.ends[2 * spring], net.ends[2 * spring + 1]];
    const [a, b] = [3 * first, 3 * second];
    let distance = Infinity;
    if (places[a + 2] <= 1 && places[b + 2] <= 1) {
      distance = distanceTo(places[a], places[a + 1], places[b], places[b + 1], x, y);
    } else if (places[a + 2] <= 1 || places[b + 2] <= 1) {
      const seen = projection.seen(first, second);
      if (seen) distance = distanceTo(...seen, x, y);
    }
    if (distance < least) {
      best = spring;
      least = distance;
    }
  }
  return best;
}

/** Distance of a point from a line between two others [px]. */
function distanceTo(ax: number, ay: number, bx: number, by: number, x: number, y: number): number {
  const [dx, dy, px, py] = [bx - ax, by - ay, x - ax, y - ay];
  const square = dx * dx + dy * dy;
  const share = square > 0 ? Math.min(1, Math.max(0, (px * dx + py * dy) / square)) : 0;
  return Math.hypot(px - share * dx, py - share * dy);
}

function frontCell(net: Net, projection: Projection, x: number, y: number): number {
  let best = -1;
  let front = 1;
  const { places } = projection;
  for (const cell of projection.cellsNear(net, x, y)) {
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
