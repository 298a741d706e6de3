// Two nets side by side in one canvas, seen by one eye: whatever moves it moves both.
import * as THREE from "three";
import { colouringOf } from "../document/colouring";
import { type Comparison, sharedColour } from "../document/comparing";
import { positionOf } from "../document/motion";
import type { Colour } from "../document/palettes";
import { clipped, cutOf, keeps } from "../document/section";
import type { State } from "../document/store";
import type { Eye } from "./camera";
import { Hairlines } from "./hairlines";
import { endsOf, STILL_RIBBONS, WIDTH, widthsOf } from "./lines";
import { Discs } from "./points";
import { Ribbons } from "./ribbons";

/** Positions of both nets, for what has to hold of both [m]. */
export function bothPositions(nets: Comparison["nets"]): Float32Array | null {
  const [first, second] = nets;
  if (!first || !second) return null;
  const both = new Float32Array(first.motion.positions.length + second.motion.positions.length);
  both.set(first.motion.positions);
  both.set(second.motion.positions, first.motion.positions.length);
  return both;
}

/** Draws a pair of nets. */
export class Pair {
  private readonly halves = [new Half(), new Half()];

  /** Takes nets, colours and what is shown of them. */
  set(nets: Comparison["nets"], { view, theme }: State, anchor: Colour): void {
    const both = bothPositions(nets);
    const colour = sharedColour(nets, view.colour);
    const cut = both && cutOf(view.section, both);
    nets.forEach((pictured, at) => {
      const half = this.halves[at];
      half.shown = pictured !== null;
      if (!pictured) return;
      const { net, motion } = pictured;
      const lines = clipped(cut, {
        count: net.ends.length / 2,
        ends: endsOf(net, motion.positions),
        colours: colouringOf(net, motion, colour, theme).colours,
        widths: view.thickness ? widthsOf(net, motion, colour) : WIDTH,
      });
      half.springs = lines.count;
      half.ribbons.set(lines.count, lines.ends, lines.colours, lines.widths);
      half.hairlines.set(lines.count, lines.ends, lines.colours);
      half.discs.set(
        view.anchors
          ? [...net.anchors]
              .filter((node) => keeps(cut, motion.positions, node))
              .map((node) => ({ at: positionOf(motion, node), colour: anchor, size: 8 }))
          : [],
      );
    });
  }

  /** Draws both halves; `fine` is false while a software rasteriser has to be quick. */
  draw(
    renderer: THREE.WebGLRenderer,
    eye: Eye,
    [width, height]: [number, number],
    ground: THREE.Color,
    { fine, software }: { fine: boolean; software: boolean },
  ): void {
    const scale = renderer.getPixelRatio();
    const half = Math.floor(width / 2);
    renderer.setScissorTest(true);
    this.halves.forEach((one, at) => {
      const place: [number, number, number, number] = [at * half, 0, half, height];
      renderer.setViewport(...place);
      renderer.setScissor(...place);
      one.ribbons.fit(half * scale, height * scale, scale, ground, eye.haze());
      one.discs.fit(scale, ground);
      const ribbons = fine && (!software || one.springs <= STILL_RIBBONS);
      one.ribbons.mesh.visible = ribbons && one.shown;
      one.hairlines.lines.visible = !ribbons && one.shown;
      one.discs.points.visible = one.shown;
      renderer.render(one.scene, eye.camera);
    });
    renderer.setScissorTest(false);
    renderer.setViewport(0, 0, width, height);
  }

  dispose(): void {
    for (const { ribbons, hairlines, discs } of this.halves) {
      ribbons.dispose();
      hairlines.dispose();
      discs.dispose();
    }
  }
}

class Half {
  readonly scene = new THREE.Scene();
  readonly ribbons = new Ribbons();
  readonly hairlines = new Hairlines();
  readonly discs = new Discs();
  springs = 0;
  shown = false;

  constructor() {
    this.scene.add(this.ribbons.mesh, this.hairlines.lines, this.discs.points);
  }
}
