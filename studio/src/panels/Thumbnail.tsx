// A net at a glance, drawn flat: springs coloured by force, near ones over far ones.
import { memo, useEffect, useRef } from "react";
import { tableOf } from "../document/palettes";
import { type Pictured, wish } from "../document/pictured";
import { placeOn, scaleOf } from "../document/scale";
import { penOf } from "./canvas";
import { useStudio } from "./use";

export const Thumbnail = memo(function Thumbnail({
  path,
  revision = "",
  width,
  height,
}: {
  path: string;
  /** Pictures at one path are drawn anew when this changes. */
  revision?: string;
  width: number;
  height: number;
}) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const theme = useStudio((state) => state.theme);
  const palette = useStudio((state) => state.view.colour.palette);
  useEffect(
    () =>
      wish(path, revision, (picture) => {
        if (canvas.current) draw(canvas.current, picture, width, height, tableOf(palette, theme));
      }),
    [path, revision, width, height, palette, theme],
  );
  return <canvas ref={canvas} className="thumbnail" style={{ width, height }} />;
});

/** Direction from which all thumbnails are seen: right, up and towards the eye, each of unit length. */
const RIGHT = [0.85, 0.527, 0];
const TOWARDS = [0.49, -0.79, 0.37];
const UP = [-0.195, 0.315, 0.929];

function draw(
  canvas: HTMLCanvasElement,
  { net, motion }: Pictured,
  width: number,
  height: number,
  table: Uint8Array,
): void {
  const context = penOf(canvas, width, height);
  if (!context) return;
  const count = net.nodes.length;
  const places = new Float32Array(3 * count);
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  const along = (axes: number[], at: number) =>
    axes[0] * motion.positions[at] +
    axes[1] * motion.positions[at + 1] +
    axes[2] * motion.positions[at + 2];
  for (let at = 0; at < 3 * count; at += 3) {
    places[at] = along(RIGHT, at);
    places[at + 1] = -along(UP, at);
    places[at + 2] = along(TOWARDS, at);
    box[0] = Math.min(box[0], places[at]);
    box[1] = Math.min(box[1], places[at + 1]);
    box[2] = Math.max(box[2], places[at]);
    box[3] = Math.max(box[3], places[at + 1]);
  }
  const margin = 10;
  const size = Math.min(
    (width - 2 * margin) / (box[2] - box[0] || 1),
    (height - 2 * margin) / (box[3] - box[1] || 1),
  );
  const x = (node: number) => width / 2 + size * (places[3 * node] - (box[0] + box[2]) / 2);
  const y = (node: number) => height / 2 + size * (places[3 * node + 1] - (box[1] + box[3]) / 2);
  const scale = scaleOf(motion.forces, { mode: "percentile", logarithmic: false, fixed: [0, 1] });
  const springs = Array.from(motion.forces.keys());
  const depth = (spring: number) =>
    places[3 * net.ends[2 * spring] + 2] + places[3 * net.ends[2 * spring + 1] + 2];
  springs.sort((a, b) => depth(a) - depth(b));
  const near = depth(springs[springs.length - 1] ?? 0);
  const far = depth(springs[0] ?? 0);
  context.lineWidth = springs.length > 3000 ? 0.5 : 0.9;
  for (const spring of springs) {
    const shade = 3 * Math.round(255 * placeOn(scale, motion.forces[spring]));
    const opacity = near > far ? 0.3 + (0.7 * (depth(spring) - far)) / (near - far) : 1;
    context.strokeStyle = `rgb(${table[shade]} ${table[shade + 1]} ${table[shade + 2]} / ${opacity.toFixed(2)})`;
    context.beginPath();
    context.moveTo(x(net.ends[2 * spring]), y(net.ends[2 * spring]));
    context.lineTo(x(net.ends[2 * spring + 1]), y(net.ends[2 * spring + 1]));
    context.stroke();
  }
}
