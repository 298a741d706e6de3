// Selecting cells: by a box or a lasso on the screen, or by what they have in common with one.
import { grafting } from "../document/grafting";
import { groupOf, type Net } from "../document/net";
import { bandOf, selectBy, topLevel } from "../document/planning";
import { select, store } from "../document/store";
import type { Hit } from "../viewport/picking";
import type { Viewport } from "../viewport/scene";
import type { Pointer, Tool } from "./tool";

type Outline = [number, number][];

/** Box and lasso: an outline is drawn, and the cells whose middle lies in it are selected. */
export class Outlining implements Tool {
  readonly reach = {};
  readonly cursor = "crosshair";
  private start: [number, number] = [0, 0];

  constructor(private readonly box: boolean) {}

  down(_: Viewport, __: Hit | null, { x, y }: Pointer): boolean {
    this.start = [x, y];
    grafting.setState({ outline: [[x, y]] });
    return true;
  }

  drag(_: Viewport, __: Hit | null, { x, y }: Pointer): void {
    const [left, top] = this.start;
    const { outline } = grafting.getState();
    const next: Outline = this.box
      ? [[left, top], [x, top], [x, y], [left, y]] // biome-ignore format: one corner after the other
      : [...outline, [x, y]];
    grafting.setState({ outline: next });
  }

  drop(viewport: Viewport, pointer: Pointer): void {
    const { outline } = grafting.getState();
    grafting.setState({ outline: [] });
    const { net, selection } = store.getState();
    if (!net || outline.length < 3) return;
    const before = pointer.shift && selection.kind === "cells" ? selection.keys : [];
    const rows = cellsWithin(net, viewport, outline, pointer.control);
    const keys = rows.map((row) => net.addresses[row]);
    select({ kind: "cells", keys: [...new Set([...before, ...keys])] });
  }

  click(): void {
    this.cancel();
  }

  hover(): void {}

  cancel(): void {
    grafting.setState({ outline: [] });
  }
}

/** Cells in front whose middle lies in an outline; `through` takes those behind them too. */
function cellsWithin(net: Net, viewport: Viewport, outline: Outline, through: boolean): number[] {
  const { motion } = store.getState();
  if (!motion) return [];
  const found: number[] = [];
  for (let cell = 0; cell < net.addresses.length; cell++) {
    const around = groupOf(net.boundaries, cell);
    const middle: [number, number, number] = [0, 0, 0];
    for (const node of around)
      for (let axis = 0; axis < 3; axis++)
        middle[axis] += motion.positions[3 * node + axis] / around.length;
    const place = viewport.project(middle);
    if (!place || !within(outline, place)) continue;
    if (through || viewport.pick(place[0], place[1], { cells: true })?.row === cell)
      found.push(cell);
  }
  return found;
}

function within(outline: Outline, [x, y]: [number, number]): boolean {
  let inside = false;
  for (let at = 0, last = outline.length - 1; at < outline.length; last = at++) {
    const a = outline[at];
    const b = outline[last];
    if (a[1] > y !== b[1] > y && x < ((b[0] - a[0]) * (y - a[1])) / (b[1] - a[1]) + a[0])
      inside = !inside;
  }
  return inside;
}

/** A click on a cell selects all that have something in common with it. */
export class Gathering implements Tool {
  readonly reach = { cells: true };
  readonly cursor = "cell";

  constructor(private readonly by: "row" | "loop" | "part" | "band") {}

  down(): boolean {
    return false;
  }

  drag(): void {}
  drop(): void {}
  hover(): void {}
  cancel(): void {}

  click(_: Viewport, hit: Hit | null, pointer: Pointer): void {
    const { net } = store.getState();
    if (!net || hit?.kind !== "cell") return;
    selectBy({ words: wordsOf(net, this.by, hit.row) }, pointer.shift);
  }
}

/** What the cells have in common with one, in words. */
export function wordsOf(net: Net, by: "row" | "loop" | "part" | "band", cell: number): string {
  if (by === "band") return bandOf(cell);
  if (by === "part") return `part("${net.parts[net.cellPart[cell]]}")`;
  return `${by}(${topLevel(net.addresses[cell])})`;
}

/** A click on an anchor or a node selects the ring of cells round it; each further click a ring more. */
export class Ringing implements Tool {
  readonly reach = { nodes: true };
  readonly cursor = "cell";
  private last = "";
  private rings = 0;

  down(): boolean {
    return false;
  }

  drag(): void {}
  drop(): void {}
  hover(): void {}

  cancel(): void {
    this.last = "";
  }

  click(_: Viewport, hit: Hit | null, pointer: Pointer): void {
    const { net } = store.getState();
    if (!net || hit?.kind !== "node") return;
    const node = net.nodes[hit.row];
    this.rings = node === this.last ? this.rings + 1 : 1;
    this.last = node;
    const level = node.startsWith("v") ? "" : `, ${levelOf(node)}`;
    selectBy({ words: `rings("${node}", ${this.rings}${level})` }, pointer.shift);
  }
}

/** The level of cells that have a node at a corner, from how finely its place divides a cell. */
function levelOf(node: string): number {
  const parts = [...node.matchAll(/\/(\d+)/g)].map(([, divisor]) => Math.log2(Number(divisor)));
  return Math.max(0, ...parts);
}
