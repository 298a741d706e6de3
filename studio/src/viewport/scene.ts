// The viewport: what the document holds and how it is to be seen, drawn on a canvas when either changes.
import * as THREE from "three";
import { type Colouring, colouringOf } from "../document/colouring";
import { type Comparison, comparing, isComparing } from "../document/comparing";
import { formed } from "../document/conditions";
import { grafting } from "../document/grafting";
import { type Motion, positionOf } from "../document/motion";
import { groupOf, type Net } from "../document/net";
import { type Colour, kindColour } from "../document/palettes";
import { plainType } from "../document/quantities";
import { type Cut, clipped, cutOf, keeps, type Lines } from "../document/section";
import { selectedRows } from "../document/selection";
import { type State, store } from "../document/store";
import { factorOf } from "../document/weights";
import { arrowsOf } from "./arrows";
import { Eye, type StandardView } from "./camera";
import { type Axis, armedNode, armLength, armUnder, type Guide, guideLines } from "./guides";
import { Hairlines } from "./hairlines";
import { endsOf, STILL_RIBBONS, WIDTH, widthsOf } from "./lines";
import { bothPositions, Pair } from "./pair";
import { type Hit, Projection, pick } from "./picking";
import { type Disc, Discs } from "./points";
import { Ribbons } from "./ribbons";
import { Skin } from "./skin";
import { type Captions, captionsOf, type Legend, svgOf } from "./vector";
import { Words } from "./words";

const GROUND: Record<State["theme"], string> = { dark: "#0e1117", light: "#f6f7f9" };
const INK: Record<State["theme"], Colour> = { dark: [244, 246, 250], light: [22, 26, 33] };
const ANCHOR: Record<State["theme"], Colour> = { dark: [244, 246, 250], light: [30, 36, 45] };
const ARROW: Record<State["theme"], Colour> = { dark: [124, 156, 255], light: [52, 88, 210] };
const GROW_HERE: Record<State["theme"], Colour> = { dark: [86, 197, 150], light: [13, 107, 64] };
const KEEP_OUT: Record<State["theme"], Colour> = { dark: [255, 110, 100], light: [179, 42, 36] };
const MARK: Record<State["theme"], Colour> = { dark: [124, 156, 255], light: [52, 88, 210] };
const COMING: Record<State["theme"], Colour> = { dark: [76, 195, 138], light: [21, 128, 79] };
const GOING: Record<State["theme"], Colour> = { dark: [255, 77, 79], light: [214, 32, 36] };

const GHOST: Record<State["theme"], Colour> = { dark: [86, 214, 170], light: [10, 122, 84] };

const SELECTED_WIDTH = 3.4; // px
const STILL_AFTER = 180; // ms
/** While nets come one after the other a pause between two is no rest. */
const STILL_AFTER_NETS = 2500; // ms

/** Length of the longest reaction arrow over the radius of the net. */
const ARROW_SHARE = 0.28;

// Colours are given as they are shown; nothing here is lit.
THREE.ColorManagement.enabled = false;

/** Height of what names two nets that are compared, and of their scale [px]. */
const HEADING = 96;

/** Draws what the store holds; made once for a canvas. */
export class Viewport {
  readonly eye: Eye;
  /** Told after every drawing, for what lies over the canvas. */
  onDraw: () => void = () => {};
  /** A line from a node to a place, such as a spring that is being added. */
  rubber: { from: [number, number, number]; to: [number, number, number] } | null = null;
  /** Directions along which what is dragged moves. */
  guide: Guide | null = null;
  /** Cells under the brush. */
  brushed = new Set<number>();
  colouring: Colouring | null = null;
  readonly software: boolean;

  private readonly renderer: THREE.WebGLRenderer;
  private readonly scene = new THREE.Scene();
  private readonly ribbons = new Ribbons();
  private readonly hairlines = new Hairlines();
  private readonly marked = new Ribbons({ lift: 0.0003, order: 2, haze: 0 });
  private readonly arrows = new Ribbons({ lift: 0.0002, order: 2, haze: 0.2 });
  private readonly ghost = new Ribbons({ lift: 0.0004, order: 2, haze: 0.2 });
  private readonly guides = new Ribbons({ lift: 0.02, order: 3, haze: 0 });
  private readonly patch = new Ribbons({ lift: 0.0006, order: 3, haze: 0 });
  private readonly skin = new Skin(0.16);
  private readonly markedSkin = new Skin(0.34);
  private readonly discs = new Discs();
  private readonly pair = new Pair();
  private readonly ground = new THREE.Color();
  private width = 1;
  private height = 1;
  private asked = 0;
  private lastMove = 0;
  private stillTimer = 0;
  private fitted: string | null = null;
  private paired = false;
  private drawnRevision = 0;
  private dirty = true;
  private projection: Projection | null = null;
  private readonly stop: () => void;
  private readonly observer: ResizeObserver;

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.renderer = new THREE.WebGLRenderer({
      canvas,
      antialias: true,
      powerPreference: "high-performance",
    });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    this.software = isSoftware(this.renderer.getContext());
    this.scene.fog = new THREE.Fog(0, 0, 1);
    const { mesh } = this.ribbons;
    this.scene.add(mesh, this.hairlines.lines, this.marked.mesh, this.arrows.mesh);
    this.scene.add(this.ghost.mesh, this.guides.mesh, this.patch.mesh);
    this.scene.add(this.skin.mesh, this.markedSkin.mesh, this.discs.points);
    this.eye = new Eye(canvas, () => {
      this.lastMove = performance.now();
      this.redraw();
    });
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(canvas.parentElement!);
    this.resize();
    const stops = [
      store.subscribe((state, before) => this.follow(state, before)),
      grafting.subscribe(({ plan }, before) => plan !== before.plan && this.redraw(true)),
      comparing.subscribe((state, before) => this.followPair(state, before)),
    ];
    this.stop = () => {
      for (const stop of stops) stop();
    };
    this.follow(store.getState(), null);
  }

  /** Shows what the pointer would do here. */
  point(cursor: string): void {
    this.canvas.style.cursor = cursor;
  }

  /** Draws at the next chance; `changed` says that it is not only the eye that moved. */
  redraw(changed = false): void {
    this.dirty ||= changed;
    this.asked ||= requestAnimationFrame(() => this.draw());
  }

  /** Looks at the whole net. */
  fit(view: StandardView | null = null): void {
    const { motion } = store.getState();
    const positions = isComparing()
      ? bothPositions(comparing.getState().nets)
      : (motion?.positions ?? null);
    if (!positions) return;
    this.eye.measure(positions);
    this.eye.fit(view, true);
    this.redraw();
  }

  /** Whether the net is in the picture, and larger than a dot. */
  showsNet(): boolean {
    const { motion } = store.getState();
    if (!motion?.positions.length || isComparing()) return true;
    // The eye may have been moved since the last picture, or be on its way.
    if (this.eye.update()) return true;
    return this.eye.sees(motion.positions, this.width, this.height);
  }

  /** What lies under a point of the canvas [px]. */
  pick(x: number, y: number, kinds: Parameters<typeof pick>[4]): Hit | null {
    const { net, motion, view } = store.getState();
    if (!net || !motion || isComparing()) return null;
    const { section } = view;
    const look = {
      motion,
      camera: this.eye.camera,
      width: this.width,
      height: this.height,
      section,
    };
    if (!this.projection?.holds(look)) this.projection = new Projection(look);
    return pick(net, this.projection, x, y, kinds);
  }

  /** Where a place of the net is on the canvas [px]; null if it is behind the eye. */
  project([x, y, z]: [number, number, number], half: 0 | 1 | null = null): [number, number] | null {
    const seen = new THREE.Vector3(x, y, z).project(this.eye.camera);
    if (seen.z > 1 || (half !== null && Math.abs(seen.x) > 1)) return null;
    const width = half === null ? this.width : this.width / 2;
    const left = half === 1 ? width : 0;
    return [left + (seen.x + 1) * 0.5 * width, (1 - seen.y) * 0.5 * this.height];
  }

  /** The arm of the selected node under a point of the canvas [px]. */
  armUnder(x: number, y: number): { node: number; axis: Axis } | null {
    const state = store.getState();
    const node = armedNode(state);
    if (node === null) return null;
    const place = new THREE.Vector3(...positionOf(state.motion!, node));
    const length = armLength(this.eye.camera, place, this.height);
    const axis = armUnder((point) => this.project(point), place, length, x, y);
    return axis === null ? null : { node, axis };
  }

  /** The ray through a point of the canvas [px]. */
  ray(x: number, y: number): THREE.Ray {
    const caster = new THREE.Raycaster();
    caster.setFromCamera(
      new THREE.Vector2((x / this.width) * 2 - 1, 1 - (y / this.height) * 2),
      this.eye.camera,
    );
    return caster.ray;
  }

  /** The picture as a PNG, twice as fine as the screen, with ribbons however slow they are and what is said over it. */
  async picture(legend: Legend | null): Promise<Blob> {
    const words = await Words.of(captionsOf(this.captions(legend)));
    const screen = this.renderer.getPixelRatio();
    const most = this.renderer.capabilities.maxTextureSize / Math.max(this.width, this.height);
    this.renderer.setPixelRatio(Math.min(2 * screen, most));
    this.render(true);
    const picture = words.over(this.canvas);
    this.renderer.setPixelRatio(screen);
    this.render(true);
    return picture;
  }

  /** The picture as an SVG file: what the canvas shows, as lines. */
  drawing(legend: Legend | null): Blob {
    const { net, motion, view } = store.getState();
    if (!net || !motion) throw new Error("there is no net to draw");
    const cut = cutOf(view.section, motion.positions);
    const text = svgOf({
      ...this.captions(legend),
      springs: this.lines(net, motion, cut),
      arrows: this.arrowLines(cut),
      haze: this.eye.haze(),
    });
    return new Blob([text], { type: "image/svg+xml" });
  }

  /** What is said over the picture; names of anchors only of one net. */
  private captions(legend: Legend | null): Captions {
    const { net, motion, theme, view } = store.getState();
    const cut = motion && cutOf(view.section, motion.positions);
    const named = net && motion && view.anchors && !isComparing() ? [...net.anchors] : [];
    return {
      width: this.width,
      height: this.height,
      camera: this.eye.camera,
      ground: GROUND[theme],
      ink: `rgb(${INK[theme].join(",")})`,
      anchors: named
        .map((node, number) => ({ node, name: net!.anchorNames[number] }))
        .filter(({ node }) => keeps(cut, motion!.positions, node))
        .map(({ node, name }) => ({ at: positionOf(motion!, node), name })),
      legend,
    };
  }

  dispose(): void {
    this.stop();
    this.observer.disconnect();
    cancelAnimationFrame(this.asked);
    clearTimeout(this.stillTimer);
    for (const part of [
      this.ribbons,
      this.hairlines,
      this.marked,
      this.arrows,
      this.ghost,
      this.guides,
      this.patch,
      this.skin,
      this.markedSkin,
      this.discs,
      this.pair,
    ]) {
      part.dispose();
    }
    this.eye.dispose();
    this.renderer.dispose();
  }

  private follow(state: State, before: State | null): void {
    if (state.motion !== before?.motion && state.motion) {
      if (before?.motion) this.lastMove = performance.now();
      if (this.fitted !== state.document?.document) {
        this.fitted = state.document?.document ?? null;
        this.eye.measure(state.motion.positions);
        this.eye.fit("perspective", false);
      }
    }
    const seen: (keyof State)[] = [
      "motion",
      "selection",
      "hover",
      "view",
      "theme",
      "document",
      "tool",
      "preview",
      "live",
    ];
    if (!before || seen.some((key) => state[key] !== before[key])) this.redraw(true);
  }

  /** Makes room for a pair of nets, and looks at both once they are there. */
  private followPair(state: Comparison, before: Comparison): void {
    if ((state.sides === null) !== (before.sides === null)) this.resize();
    const came = bothPositions(state.nets);
    if (state.sides && came && !bothPositions(before.nets)) {
      this.eye.measure(came);
      // Two nets that are exchanged are seen as the ones before were.
      if (!this.paired) this.eye.fit(null, false);
      this.paired = true;
    }
    if (!state.sides && this.paired) {
      this.paired = false;
      this.fit();
    }
    this.redraw(true);
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.canvas.parentElement!;
    this.width = Math.max(1, clientWidth);
    this.height = Math.max(1, clientHeight);
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(this.width, this.height, false);
    const both = isComparing();
    if (both) this.eye.resize(this.width / 2, this.height, Math.max(this.height - HEADING, 1));
    else this.eye.resize(this.width, this.height);
    this.eye.controls.zoomToCursor = !both;
    if (this.paired) this.eye.fit(null, false);
    this.redraw(true);
  }

  private draw(): void {
    this.asked = 0;
    const gliding = this.eye.update();
    const { motion } = store.getState();
    const rest = isRestless() ? STILL_AFTER_NETS : STILL_AFTER;
    const still = performance.now() - this.lastMove > rest && !gliding;
    clearTimeout(this.stillTimer);
    this.render(!this.software || still);
    // For whoever looks at the page: whether the picture is as fine as it will be.
    this.canvas.dataset.fine = String(!this.software || still);
    if (gliding) {
      this.lastMove = performance.now();
      this.redraw();
    } else if (this.software && !still) {
      this.stillTimer = window.setTimeout(() => this.redraw(), rest + 20);
    }
    if (motion) this.onDraw();
  }

  private render(fine: boolean): void {
    const state = store.getState();
    const { net, motion, theme } = state;
    this.ground.set(GROUND[theme]);
    this.renderer.setClearColor(this.ground);
    const haze = this.eye.haze();
    const fog = this.scene.fog as THREE.Fog;
    fog.color.copy(this.ground);
    // A hairline has no width to be thinned by distance, so the haze is weaker.
    fog.near = haze.x;
    fog.far = haze.y + 0.6 * (haze.y - haze.x);
    if (isComparing()) {
      if (this.dirty) this.pair.set(comparing.getState().nets, state, ANCHOR[theme]);
      this.dirty = false;
      const quality = { fine, software: this.software };
      this.pair.draw(this.renderer, this.eye, [this.width, this.height], this.ground, quality);
      return;
    }
    const scale = this.renderer.getPixelRatio();
    const size = this.renderer.getDrawingBufferSize(new THREE.Vector2());
    const every = [this.ribbons, this.marked, this.arrows, this.ghost, this.guides, this.patch];
    for (const ribbons of every) ribbons.fit(size.x, size.y, scale, this.ground, haze);
    this.discs.fit(scale, this.ground);
    const current = net && motion && motion.header.revision === net.revision;
    if (current && (this.dirty || this.drawnRevision !== net.revision)) {
      this.update(state, net, motion);
      this.drawnRevision = net.revision;
      // For whoever looks at the page: which net it shows.
      this.canvas.dataset.revision = String(net.revision);
      this.dirty = false;
    }
    for (const child of this.scene.children) child.visible &&= this.drawnRevision > 0;
    const ribbons = fine && (!this.software || (net?.ends.length ?? 0) / 2 <= STILL_RIBBONS);
    this.ribbons.mesh.visible = ribbons && this.drawnRevision > 0;
    this.hairlines.lines.visible = !ribbons && this.drawnRevision > 0;
    if (current) this.updateOverlays(state, motion);
    this.renderer.render(this.scene, this.eye.camera);
  }

  private update(state: State, net: Net, motion: NonNullable<State["motion"]>): void {
    const { view, theme } = state;
    this.colouring = colouringOf(net, motion, view.colour, theme);
    const lines = this.lines(net, motion, cutOf(view.section, motion.positions));
    this.ribbons.set(lines.count, lines.ends, lines.colours, lines.widths);
    this.hairlines.set(lines.count, lines.ends, lines.colours);
    this.updateMarks(state, net, motion);
    this.updateSkin(state, net, motion);
    this.updatePatch(theme);
    this.discs.set(discsOf(state, net, motion));
  }

  /** The springs as they are seen. */
  private lines(net: Net, motion: Motion, cut: Cut | null): Lines {
    const { view, theme } = store.getState();
    const seen = this.colouring ?? colouringOf(net, motion, view.colour, theme);
    const { colours, conditions } = seen;
    const widths = view.thickness ? widthsOf(net, motion, view.colour) : WIDTH;
    const count = net.ends.length / 2;
    const springs = { count, ends: endsOf(net, motion.positions), colours, widths };
    return clipped(cut, formed(springs, conditions));
  }

  private updateMarks({ selection, hover, theme, view }: State, net: Net, motion: Motion): void {
    const springs = new Set(selectedRows(net, selection, "springs"));
    const chosen = [...springs];
    const lit = hover?.kind === "spring" && !springs.has(hover.row) ? hover.row : -1;
    if (lit >= 0) chosen.push(lit);
    const outline = outlineOf(net, selectedRows(net, selection, "cells"));
    const count = chosen.length + outline.length + (this.rubber ? 1 : 0);
    const ends = endsOf(net, motion.positions);
    const places = new Float32Array(6 * count);
    const colours = new Uint8Array(3 * count);
    const widths = new Float32Array(count);
    chosen.forEach((spring, at) => {
      places.set(ends.subarray(6 * spring, 6 * spring + 6), 6 * at);
      colours.set(INK[theme], 3 * at);
      widths[at] =
        spring === lit ? SELECTED_WIDTH + 0.6 : selection.kind === "springs" ? SELECTED_WIDTH : 2.2;
    });
    outline.forEach(([from, to], side) => {
      const at = chosen.length + side;
      places.set([...positionOf(motion, from), ...positionOf(motion, to)], 6 * at);
      colours.set(INK[theme], 3 * at);
      widths[at] = 2.4;
    });
    if (this.rubber) {
      const at = count - 1;
      places.set([...this.rubber.from, ...this.rubber.to], 6 * at);
      colours.set(MARK[theme], 3 * at);
      widths[at] = 2.4;
    }
    const cut = cutOf(view.section, motion.positions);
    const marks = clipped(cut, { count, ends: places, colours, widths });
    this.marked.set(marks.count, marks.ends, marks.colours, marks.widths);
  }

  /** Draws the cells that the patch in the hand would become, over the net. */
  private updatePatch(theme: State["theme"]): void {
    const plan = grafting.getState().plan;
    const springs = plan?.springs ?? [];
    const places = new Float32Array([...springs, ...(plan?.outline ?? [])]);
    const count = places.length / 6;
    const colours = new Uint8Array(3 * count);
    const widths = new Float32Array(count).fill(1.8);
    for (let line = 0; line < count; line++) colours.set(GHOST[theme], 3 * line);
    widths.fill(3.2, springs.length / 6);
    this.patch.set(count, places, colours, widths);
  }

  /** Arrows, guides and ghosts, some of which keep their size on the canvas. */
  private updateOverlays(state: State, motion: Motion): void {
    const { view, theme, preview } = state;
    const arrows = this.arrowLines(cutOf(view.section, motion.positions));
    this.arrows.set(arrows.count, arrows.ends, arrows.colours, arrows.widths);
    const { camera, radius } = this.eye;
    const guides = guideLines(state, camera, this.height, radius, this.guide, MARK[theme]);
    this.guides.set(
      guides.widths.length,
      new Float32Array(guides.ends),
      new Uint8Array(guides.colours),
      new Float32Array(guides.widths),
    );
    const { added = [], removed = [] } = preview?.state ?? {};
    const count = (added.length + removed.length) / 6;
    const colours = new Uint8Array(3 * count);
    for (let line = 0; line < count; line++)
      colours.set(6 * line < added.length ? COMING[theme] : GOING[theme], 3 * line);
    this.ghost.set(count, new Float32Array([...added, ...removed]), colours, 2);
  }

  private arrowLines(cut: Cut | null): Lines {
    const { view, theme, net, motion } = store.getState();
    const ends =
      view.reactions && net && motion
        ? arrowsOf(net, motion, this.eye.radius * ARROW_SHARE, this.eye.camera.position, cut)
        : new Float32Array();
    const count = ends.length / 6;
    const colours = new Uint8Array(3 * count);
    for (let line = 0; line < count; line++) colours.set(ARROW[theme], 3 * line);
    return { count, ends, colours, widths: 2.2 };
  }

  private updateSkin(
    { view, selection, theme, hover, live }: State,
    net: Net,
    motion: NonNullable<State["motion"]>,
  ): void {
    const cut = cutOf(view.section, motion.positions);
    const whole = (cell: number) =>
      !cut || groupOf(net.boundaries, cell).every((node) => keeps(cut, motion.positions, node));
    if (view.cells) {
      const all = [...net.addresses.keys()].filter(whole);
      this.skin.set(net, motion, all, cellColours(net, view.colour.by, theme));
    } else this.skin.clear();
    const cells = new Set([...selectedRows(net, selection, "cells"), ...this.brushed]);
    if (hover?.kind === "cell") cells.add(hover.row);
    const weights = live?.weights ?? {};
    const factors = new Map<number, number>();
    if (Object.keys(weights).length)
      net.addresses.forEach((address, cell) => {
        const factor = factorOf(weights, address);
        if (factor !== 1) factors.set(cell, factor);
      });
    for (const cell of factors.keys()) cells.add(cell);
    const weighed = (cell: number) =>
      (factors.get(cell) ?? 1) < 1 ? KEEP_OUT[theme] : GROW_HERE[theme];
    const chosen = new Set(selectedRows(net, selection, "cells"));
    this.markedSkin.set(net, motion, [...cells].filter(whole), (cell) =>
      chosen.has(cell) && !this.brushed.has(cell)
        ? INK[theme]
        : factors.has(cell) && hover?.row !== cell
          ? weighed(cell)
          : MARK[theme],
    );
  }
}

/** Whether the net is evolving before one's eyes. */
function isRestless(): boolean {
  const { live, run } = store.getState();
  return live?.status === "running" || (run?.state.status === "running" && run.state.following);
}

/** Sides round some cells: what has them on one side only. The springs within stay as they are coloured. */
function outlineOf(net: Net, cells: number[]): [number, number][] {
  // By the numbers of both nodes in one.
  const sides = new Map<number, [number, number]>();
  const scale = net.nodes.length;
  const { starts, items } = net.boundaries;
  for (const cell of cells) {
    let node = items[starts[cell + 1] - 1];
    for (let corner = starts[cell]; corner < starts[cell + 1]; corner++) {
      const next = items[corner];
      const key = node < next ? node * scale + next : next * scale + node;
      if (!sides.delete(key)) sides.set(key, [node, next]);
      node = next;
    }
  }
  return [...sides.values()];
}

function isSoftware(context: WebGLRenderingContext | WebGL2RenderingContext): boolean {
  const info = context.getExtension("WEBGL_debug_renderer_info");
  const name = info ? String(context.getParameter(info.UNMASKED_RENDERER_WEBGL)) : "";
  return /swiftshader|llvmpipe|software/i.test(name);
}

function discsOf({ view, selection, hover, theme, motion }: State, net: Net, _: unknown): Disc[] {
  const discs: Disc[] = [];
  const cut = cutOf(view.section, motion!.positions);
  const add = (node: number, colour: Colour, size: number) => {
    if (keeps(cut, motion!.positions, node))
      discs.push({ at: positionOf(motion!, node), colour, size });
  };
  const anchors = new Set(net.anchors);
  if (view.nodes) {
    for (let node = 0; node < net.nodes.length; node++)
      if (!anchors.has(node)) add(node, INK[theme], 5);
  }
  if (view.anchors) for (const node of net.anchors) add(node, ANCHOR[theme], 10);
  for (const node of selectedRows(net, selection, "nodes")) add(node, MARK[theme], 12);
  if (hover?.kind === "node") add(hover.row, MARK[theme], anchors.has(hover.row) ? 13 : 10);
  for (const node of motion!.header.held) add(node, MARK[theme], 13);
  return discs;
}

function cellColours(net: Net, by: string, theme: State["theme"]): (cell: number) => Colour {
  const words = [...new Set(net.types.map(plainType))].sort();
  const deepest = net.cellLevel.reduce((a, b) => Math.max(a, b), 0) + 1;
  if (by === "level") return (cell) => kindColour(net.cellLevel[cell], deepest, theme, true);
  if (by === "part")
    return (cell) => kindColour(net.cellPart[cell], net.parts.length, theme, false);
  return (cell) =>
    kindColour(words.indexOf(plainType(net.types[cell])), words.length, theme, false);
}
