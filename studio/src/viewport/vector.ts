// The picture as SVG: every spring a line of its own, as the camera sees it, with names and a legend in real text.
import * as THREE from "three";
import {
  type Colour,
  cssColour,
  cssGradient,
  type PaletteId,
  type Theme,
} from "../document/palettes";
import type { Lines } from "../document/section";

/** Words over a picture. */
export interface Captions {
  width: number;
  height: number;
  camera: THREE.PerspectiveCamera;
  ground: string;
  ink: string;
  /** Places with a name [m]. */
  anchors: { at: [number, number, number]; name: string }[];
  legend: Legend | null;
}

/** What is drawn. */
export interface Drawing extends Captions {
  /** Drawn far to near, each as wide as on the canvas [px]. */
  springs: Lines;
  /** Drawn over the springs. */
  arrows: Lines;
  /** Depths between which the ground shines through, as on the canvas [m]. */
  haze: THREE.Vector2;
}

/** What the colours mean: the ends of a scale, or kinds one by one. */
export type Legend =
  | {
      title: string;
      formula: string;
      low: string;
      high: string;
      palette: PaletteId;
      theme: Theme;
    }
  | { title: string; kinds: { name: string; colour: Colour }[] };

const HAZE = 0.62;
const FONT = "Inter, Helvetica, Arial, sans-serif";

/** The drawing as the text of an SVG file. */
export function svgOf(drawing: Drawing): string {
  const { width, height, ground } = drawing;
  const parts = [
    opening(drawing),
    `<rect width="${width}" height="${height}" fill="${ground}"/>`,
    `<g id="springs" fill="none" stroke-linecap="round">`,
    ...lines(drawing, drawing.springs, HAZE),
    `</g>`,
    `<g id="reactions" fill="none" stroke-linecap="round">`,
    ...lines(drawing, drawing.arrows, 0),
    `</g>`,
    ...captions(drawing),
    `</svg>`,
  ];
  return `${parts.join("\n")}\n`;
}

/** Nothing but the words of a drawing, to be laid over another picture, as the text of an SVG file. */
export function captionsOf(said: Captions): string {
  return [opening(said), ...captions(said), `</svg>`].join("\n");
}

function opening({ width, height }: Captions): string {
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}">`;
}

function captions(said: Captions): string[] {
  return [
    `<g id="anchors" fill="${said.ink}" font-family="${FONT}" font-size="12">`,
    ...said.anchors.flatMap(({ at, name }) => anchor(said, at, name)),
    `</g>`,
    ...legend(said),
  ];
}

function lines({ camera, width, height, ground, haze }: Drawing, set: Lines, strength: number) {
  const back = new THREE.Color(ground);
  const found: { depth: number; text: string }[] = [];
  const ends = [new THREE.Vector3(), new THREE.Vector3()];
  for (let line = 0; line < set.count; line++) {
    ends.forEach((end, at) => {
      end.fromArray(set.ends, 6 * line + 3 * at).applyMatrix4(camera.matrixWorldInverse);
    });
    if (!beforeTheEye(ends, -camera.near)) continue;
    const depth = -(ends[0].z + ends[1].z) / 2;
    const far = Math.min(1, Math.max(0, (depth - haze.x) / Math.max(haze.y - haze.x, 1e-6)));
    const [x1, y1, x2, y2] = ends.flatMap((end) => {
      end.applyMatrix4(camera.projectionMatrix);
      return [((end.x + 1) / 2) * width, ((1 - end.y) / 2) * height];
    });
    const colour = new THREE.Color(
      ...([0, 1, 2].map((part) => set.colours[3 * line + part] / 255) as Colour),
    ).lerp(back, far * strength);
    const size = typeof set.widths === "number" ? set.widths : set.widths[line];
    const place = `x1="${short(x1)}" y1="${short(y1)}" x2="${short(x2)}" y2="${short(y2)}"`;
    found.push({
      depth,
      text: `<line ${place} stroke="#${colour.getHexString(THREE.LinearSRGBColorSpace)}" stroke-width="${short(size)}"/>`,
    });
  }
  return found.sort((a, b) => b.depth - a.depth).map(({ text }) => text);
}

/** Shortens a line in the eye's space to what lies before a depth; false if nothing does. */
function beforeTheEye([a, b]: THREE.Vector3[], near: number): boolean {
  if (a.z > near && b.z > near) return false;
  if (a.z > near) a.lerp(b, (a.z - near) / (a.z - b.z));
  if (b.z > near) b.lerp(a, (b.z - near) / (b.z - a.z));
  return true;
}

function anchor(
  { camera, width, height, ground }: Captions,
  at: [number, number, number],
  name: string,
) {
  const seen = new THREE.Vector3(...at).project(camera);
  if (seen.z > 1) return [];
  const x = ((seen.x + 1) / 2) * width;
  const y = ((1 - seen.y) / 2) * height;
  return [
    `<circle cx="${short(x)}" cy="${short(y)}" r="4.5" stroke="${ground}" stroke-width="1.5"/>`,
    `<text x="${short(x + 9)}" y="${short(y - 8)}">${escaped(name)}</text>`,
  ];
}

function legend({ legend: said, height, ink }: Captions): string[] {
  if (!said) return [];
  const top = height - 70 - ("kinds" in said ? 18 * Math.max(0, said.kinds.length - 3) : 0);
  return [
    `<g id="legend" fill="${ink}" font-family="${FONT}" font-size="12">`,
    `<text x="20" y="${top}" font-weight="600">${escaped(said.title)}</text>`,
    ...("kinds" in said ? kinds(said.kinds, top) : scale(said, top)),
    `</g>`,
  ];
}

function kinds(all: { name: string; colour: Colour }[], top: number): string[] {
  return all.flatMap(({ name, colour }, row) => [
    `<rect x="20" y="${top + 9 + 18 * row}" width="22" height="8" rx="3" fill="${commaed(cssColour(colour))}"/>`,
    `<text x="50" y="${top + 17 + 18 * row}">${escaped(name)}</text>`,
  ]);
}

function scale(said: Extract<Legend, { low: string }>, top: number): string[] {
  const stops = cssGradient(said.palette, said.theme)
    .replace(/^linear-gradient\(to right, |\)$/g, "")
    .split("), ")
    .map((colour) => (colour.endsWith(")") ? colour : `${colour})`));
  return [
    `<linearGradient id="scale">`,
    ...stops.map(
      (colour, at) =>
        `<stop offset="${short(at / (stops.length - 1))}" stop-color="${commaed(colour)}"/>`,
    ),
    `</linearGradient>`,
    `<rect x="20" y="${top + 8}" width="210" height="10" rx="3" fill="url(#scale)"/>`,
    `<text x="20" y="${top + 34}">${escaped(said.low)}</text>`,
    `<text x="230" y="${top + 34}" text-anchor="end">${escaped(said.high)}</text>`,
    `<text x="20" y="${top + 52}" font-size="11" opacity="0.7">${escaped(said.formula)}</text>`,
  ];
}

/** A colour as all programs that draw SVG read it. */
function commaed(colour: string): string {
  return colour.replace(/rgb\((\d+) (\d+) (\d+)\)/, "rgb($1,$2,$3)");
}

function short(value: number): string {
  return String(Math.round(value * 100) / 100);
}

function escaped(text: string): string {
  return text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");
}
