// All individuals of a run by springs and force differential; the Pareto set stands out. A click looks at one.
import { useEffect, useMemo, useRef, useState } from "react";
import { measureOf, type Ranking, shareOfPlace } from "../document/choosing";
import type { Theme } from "../document/palettes";
import { pinnedRows, type Side, sideOfRow } from "../document/pins";
import { paretoOf, placeOf } from "../document/run";
import { inDigits, inFull } from "../document/scale";
import { drawSoon, penOf, pixelRatio } from "./canvas";
import { clickSide, IndividualMenu } from "./IndividualMenu";
import { pixelOfShare, useRanking } from "./Sorting";
import { useStudio } from "./use";

const HEIGHT = 190; // px
const EDGE = { left: 40, right: 10, top: 10, bottom: 24 }; // px
const REACH = 10; // px

/** Share of the individuals, from the lowest differential up, that the picture shows. */
const SHOWN = 0.98;

export function Scatter() {
  const canvas = useRef<HTMLCanvasElement>(null);
  const individuals = useStudio((state) => state.individuals);
  const theme = useStudio((state) => state.theme);
  const looking = useStudio((state) => state.document?.looking ?? null);
  const ranking = useRanking();
  const sort = useStudio((state) => state.sort);
  const pins = useStudio((state) => state.pins);
  const name = useStudio((state) => state.run?.state.name ?? "");
  const [menu, setMenu] = useState<Side | null>(null);
  const chosen = (row: number) => ranking.place[row] >= 0;
  const [over, setOver] = useState<number | null>(null);
  const front = useMemo(() => paretoOf(individuals), [individuals]);
  const frame = useMemo(() => frameOf(individuals), [individuals]);
  const width = 292;

  const x = (row: number) =>
    EDGE.left +
    ((individuals.springs[row] - frame.left) / (frame.right - frame.left)) *
      (width - EDGE.left - EDGE.right);
  const y = (row: number) =>
    HEIGHT -
    EDGE.bottom -
    ((Math.log(individuals.differential[row]) - frame.low) / (frame.high - frame.low)) *
      (HEIGHT - EDGE.top - EDGE.bottom);

  // biome-ignore lint/correctness/useExhaustiveDependencies: x and y follow from the individuals
  useEffect(() => {
    const draw = () => {
      const context = canvas.current && penOf(canvas.current, width, HEIGHT);
      if (!context) return;
      drawDots(context, ranking, theme, x, y);
      const styles = getComputedStyle(document.documentElement);
      const colour = (name: string) => styles.getPropertyValue(name).trim();
      drawAxes(context, frame, width, colour("--line"), colour("--faint"));
      context.strokeStyle = context.fillStyle = colour("--accent");
      context.lineWidth = 1.4;
      context.beginPath();
      front.forEach((row, step) => {
        if (step) context.lineTo(x(row), y(row));
        else context.moveTo(x(row), y(row));
      });
      context.stroke();
      for (const row of front) if (chosen(row)) dot(context, x(row), y(row), 2.6);
      context.strokeStyle = colour("--ink");
      context.lineWidth = 1.6;
      for (const row of pinnedRows(individuals, pins, name))
        if (chosen(row) && y(row) >= EDGE.top - 1) ring(context, x(row), y(row), 5);
      const at =
        looking?.generation != null && looking.individual != null
          ? (looking.generation - 1) * individuals.population + looking.individual
          : null;
      context.fillStyle = colour("--ink");
      for (const row of [at, over])
        if (row !== null && row < individuals.springs.length) dot(context, x(row), y(row), 4.5);
    };
    return drawSoon(draw);
  }, [individuals, front, frame, theme, over, looking, ranking, pins, name]);

  const nearest = (event: React.MouseEvent): number | null => {
    const box = canvas.current!.getBoundingClientRect();
    const [px, py] = [event.clientX - box.left, event.clientY - box.top];
    let best: number | null = null;
    let least = REACH;
    const look = (row: number, favour: number) => {
      const distance = Math.hypot(x(row) - px, y(row) - py) - favour;
      if (distance < least) {
        least = distance;
        best = row;
      }
    };
    for (const row of ranking.rows) look(row, 0);
    for (const row of front) if (chosen(row)) look(row, 3);
    return best;
  };
  const told = over === null ? null : placeOf(individuals, over);
  return (
    <div className="scatter">
      <IndividualMenu
        side={menu}
        onOpen={setMenu}
        sideUnder={(event) => {
          const row = nearest(event);
          return row === null ? null : sideOfRow(individuals, row);
        }}
      >
        <canvas
          ref={canvas}
          style={{ width, height: HEIGHT, cursor: over === null ? "default" : "pointer" }}
          role="img"
          aria-label={`${inFull(ranking.rows.length)} individuals by springs and force differential, coloured by ${measureOf(sort).name.toLowerCase()}, ${front.length} of all in the Pareto set`}
          onPointerMove={(event) => setOver(nearest(event))}
          onPointerLeave={() => setOver(null)}
          onClick={(event) => {
            const row = nearest(event);
            if (row !== null) clickSide(event, sideOfRow(individuals, row));
          }}
        />
      </IndividualMenu>
      <p className="explain">
        {told && over !== null
          ? `Generation ${told.generation}, individual ${told.individual}: ${inFull(individuals.springs[over])} springs, ${inDigits(individuals.differential[over])}; rank ${inFull(ranking.place[over] + 1)} of ${inFull(ranking.rows.length)}`
          : "Springs against force differential. Click to look, right button for more."}
      </p>
    </div>
  );
}

interface Frame {
  left: number;
  right: number;
  /** Logarithms of the force differential. */
  low: number;
  high: number;
}

function frameOf({
  springs,
  differential,
}: {
  springs: Float32Array;
  differential: Float32Array;
}): Frame {
  const known = differential.filter((value) => Number.isFinite(value) && value > 0).sort();
  let left = Number.POSITIVE_INFINITY;
  let right = 0;
  for (const count of springs) {
    left = Math.min(left, count);
    right = Math.max(right, count);
  }
  if (!known.length) return { left: 0, right: 1, low: 0, high: 1 };
  const low = Math.log(known[0]);
  const high = Math.log(known[Math.floor(SHOWN * (known.length - 1))]);
  const margin = 0.05 * Math.max(high - low, 0.05);
  const gap = Math.max(1, 0.03 * (right - left));
  return { left: left - gap, right: right + gap, low: low - margin, high: high + margin };
}

function drawAxes(
  context: CanvasRenderingContext2D,
  frame: Frame,
  width: number,
  line: string,
  ink: string,
): void {
  context.font = "11px 'Inter Variable', sans-serif";
  context.fillStyle = ink;
  context.strokeStyle = line;
  context.textAlign = "right";
  context.textBaseline = "middle";
  for (const share of [0, 0.5, 1]) {
    const at = HEIGHT - EDGE.bottom - share * (HEIGHT - EDGE.top - EDGE.bottom);
    context.beginPath();
    context.moveTo(EDGE.left, at);
    context.lineTo(width - EDGE.right, at);
    context.stroke();
    context.fillText(
      inDigits(Math.exp(frame.low + share * (frame.high - frame.low))),
      EDGE.left - 6,
      at,
    );
  }
  context.textBaseline = "top";
  for (const [share, align] of [
    [0, "left"],
    [1, "right"],
  ] as const) {
    context.textAlign = align;
    const at = EDGE.left + share * (width - EDGE.left - EDGE.right);
    context.fillText(
      inFull(Math.round(frame.left + share * (frame.right - frame.left))),
      at,
      HEIGHT - EDGE.bottom + 7,
    );
  }
}

/** A square of pixels an individual, the first of the ranking on top; as bytes, since there may be many thousands. */
function drawDots(
  context: CanvasRenderingContext2D,
  ranking: Ranking,
  theme: Theme,
  x: (row: number) => number,
  y: (row: number) => number,
): void {
  const { width, height } = context.canvas;
  const image = context.createImageData(width, height);
  const pixels = new Uint32Array(image.data.buffer);
  const ratio = pixelRatio();
  const size = Math.round(2 * ratio);
  for (let place = ranking.rows.length - 1; place >= 0; place--) {
    const row = ranking.rows[place];
    const left = Math.round((x(row) - 1) * ratio);
    const top = Math.round((y(row) - 1) * ratio);
    if (!(top >= (EDGE.top - 2) * ratio && top + size < height && left >= 0)) continue;
    const pixel = pixelOfShare(shareOfPlace(ranking, place), theme);
    for (let line = top; line < top + size; line++)
      pixels.fill(pixel, line * width + left, line * width + left + size);
  }
  context.putImageData(image, 0, 0);
}

function ring(context: CanvasRenderingContext2D, x: number, y: number, radius: number): void {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.stroke();
}

function dot(context: CanvasRenderingContext2D, x: number, y: number, radius: number): void {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
}
