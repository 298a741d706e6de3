// What lies under the pointer, found in pixels: nodes before springs before cells, the nearest to the eye.
import * as THREE from "three";
import type { Motion } from "../document/motion";
import { type Groups, groupOf, type Net } from "../document/net";
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

/** Smallest and largest side of a bin [px]. */
const BINS = [4, 32];

/** What decides where nodes are on the canvas. */
export interface Look {
  motion: Motion;
  camera: THREE.Camera;
  /** [px]. */
  width: number;
  height: number;
  section: Section | null;
}

/** Cells by where they lie on the canvas, in squares that are about as large as half a cell. */
interface Bins {
  net: Net;
  cells: Groups;
  /** [px]. */
  side: number;
  across: number;
  down: number;
}

/**
 * Nodes on the canvas: x, y [px] and depth, three numbers each. What is behind the eye or taken away by a
 * section has a depth above 1.
 */
export class Projection {
  readonly places: Float32Array;
  private readonly matrix: THREE.Matrix4;
  private readonly eye: [view: THREE.Matrix4, projection: THREE.Matrix4];
  private readonly cut: Cut | null;
  private bins: Bins | null = null;

  constructor(private readonly look: Look) {
    const { motion, section, camera } = look;
    this.eye = [camera.matrixWorldInverse.clone(), camera.projectionMatrix.clone()];
    this.matrix = new THREE.Matrix4().multiplyMatrices(this.eye[1], this.eye[0]);
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
    const [view, projection] = this.eye;
    const seen =
      camera.matrixWorldInverse.equals(view) && camera.projectionMatrix.equals(projection);
    return same && sized && seen;
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

  /** Cells that may lie over a point of the canvas. */
  cellsNear(net: Net, x: number, y: number): Int32Array {
    if (this.bins?.net !== net) this.bins = this.binned(net);
    const { cells, side, across, down } = this.bins;
    const [column, row] = [Math.floor(x / side), Math.floor(y / side)];
    const inside = column >= 0 && column < across && row >= 0 && row < down;
    return inside ? groupOf(cells, row * across + column) : NONE;
  }

  private binned(net: Net): Bins {
    const { cells, boxes } = this.boxes(net);
    let sum = 0;
    for (let at = 0; at < boxes.length; at += 4)
      sum += Math.max(boxes[at + 1] - boxes[at], boxes[at + 3] - boxes[at + 2]);
    // Small bins hold few cells to look at; large ones are soon filled.
    const side = Math.min(Math.max(sum / (cells.length || 1) / 2, BINS[0]), BINS[1]);
    const across = Math.ceil(this.look.width / side);
    const down = Math.ceil(this.look.height / side);
    const starts = new Int32Array(across * down + 1);
    const each = (put: (bin: number, cell: number) => void) => {
      cells.forEach((cell, number) => {
        const [left, right, top, bottom] = [0, 1, 2, 3].map((edge) =>
          Math.floor(boxes[4 * number + edge] / side),
        );
        for (let row = Math.max(0, top); row <= Math.min(down - 1, bottom); row++)
          for (let column = Math.max(0, left); column <= Math.min(across - 1, right); column++)
            put(row * across + column, cell);
      });
    };
    each((bin) => {
      starts[bin + 1] += 1;
    });
    for (let bin = 0; bin < across * down; bin++) starts[bin + 1] += starts[bin];
    const items = new Int32Array(starts[across * down]);
    const next = starts.slice();
    each((bin, cell) => {
      items[next[bin]++] = cell;
    });
    return { net, cells: { starts, items }, side, across, down };
  }

  /** Cells that are wholly seen, and where each lies: left, right, top, bottom [px]. */
  private boxes(net: Net): { cells: number[]; boxes: number[] } {
    const { places } = this;
    const { starts, items } = net.boundaries;
    const cells: number[] = [];
    const boxes: number[] = [];
    for (let cell = 0; cell < net.addresses.length; cell++) {
      let [left, right, top, bottom] = [Infinity, -Infinity, Infinity, -Infinity];
      let whole = true;
      for (let corner = starts[cell]; corner < starts[cell + 1]; corner++) {
        const at = 3 * items[corner];
        whole &&= places[at + 2] <= 1;
        left = Math.min(left, places[at]);
        right = Math.max(right, places[at]);
        top = Math.min(top, places[at + 1]);
        bottom = Math.max(bottom, places[at + 1]);
      }
      // What a section cuts through is not drawn as a cell either.
      if (!whole) continue;
      cells.push(cell);
      boxes.push(left, right, top, bottom);
    }
    return { cells, boxes };
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

const NONE = new Int32Array();

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
  const { starts, items } = net.boundaries;
  for (const cell of projection.cellsNear(net, x, y)) {
    const [first, end] = [starts[cell], starts[cell + 1]];
    let inside = false;
    let depth = 0;
    let b = 3 * items[end - 1];
    for (let corner = first; corner < end; corner++) {
      const a = 3 * items[corner];
      depth += places[a + 2];
      const [ax, ay, bx, by] = [places[a], places[a + 1], places[b], places[b + 1]];
      if (ay > y !== by > y && x < ((bx - ax) * (y - ay)) / (by - ay) + ax) inside = !inside;
      b = a;
    }
    depth /= end - first;
    if (inside && depth < front) {
      best = cell;
      front = depth;
    }
  }
  return best;
}
