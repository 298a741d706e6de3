// Individuals as lines across axes; a drag along an axis brushes it, and all other pictures follow.
import { useEffect, useMemo, useRef, useState } from "react";
import {
  AXES,
  type Axis,
  measureOf,
  placeOnAxis,
  rangeOf,
  shareOfPlace,
} from "../document/choosing";
import { pinnedRows } from "../document/pins";
import { inDigits, inFull } from "../document/scale";
import { store } from "../document/store";
import { drawSoon, penOf } from "./canvas";
import { colourOfShade, shadeOf, useRanking } from "./Sorting";
import { useStudio } from "./use";

const WIDTH = 292; // px
const HEIGHT = 190; // px
const EDGE = { left: 22, right: 26, top: 26, bottom: 18 }; // px
const REACH = 16; // px

/** Lines that are drawn at most; more would only hide one another. */
const MOST_LINES = 3000;

const x = (axis: number) =>
  EDGE.left + (axis / (AXES.length - 1)) * (WIDTH - EDGE.left - EDGE.right);

type Range = [number, number];

function shareOf(axis: Axis, [least, most]: Range, value: number): number {
  if (most <= least) return 0.5;
  if (axis.logarithmic && least > 0) return Math.log(value / least) / Math.log(most / least);
  return (value - least) / (most - least);
}

function valueAt(axis: Axis, [least, most]: Range, share: number): number {
  if (axis.logarithmic && least > 0) return least * (most / least) ** share;
  return least + share * (most - least);
}

const y = (share: number) => HEIGHT - EDGE.bottom - share * (HEIGHT - EDGE.top - EDGE.bottom);

export function ParallelCoordinates() {
  const canvas = useRef<HTMLCanvasElement>(null);
  const individuals = useStudio((state) => state.individuals);
  const brushes = useStudio((state) => state.brushes);
  const theme = useStudio((state) => state.theme);
  const [stroke, setStroke] = useState<{ axis: number; from: number } | null>(null);
  const ranges = useMemo(() => AXES.map(({ id }) => rangeOf(individuals, id)), [individuals]);
  const ranking = useRanking();
  const sort = useStudio((state) => state.sort);
  const pins = useStudio((state) => state.pins);
  const name = useStudio((state) => state.run?.state.name ?? "");
  const looking = useStudio((state) => state.document?.looking ?? null);
  const mask = Object.keys(brushes).length > 0;
  useEffect(() => {
    const draw = () => {
      const context = canvas.current && penOf(canvas.current, WIDTH, HEIGHT);
      if (!context) return;
      const styles = getComputedStyle(document.documentElement);
      const colour = (name: string) => styles.getPropertyValue(name).trim();
      const count = individuals.springs.length;
      const line = (row: number) => {
        AXES.forEach((axis, at) => {
          const share = shareOf(axis, ranges[at], placeOnAxis(individuals, axis.id, row));
          if (!Number.isFinite(share)) return;
          if (at) context.lineTo(x(at), y(share));
          else context.moveTo(x(at), y(share));
        });
      };
      context.lineWidth = 0.6;
      context.strokeStyle = colour("--line-strong");
      context.globalAlpha = 0.35;
      context.beginPath();
      for (let row = 0; row < count; row += Math.max(1, Math.ceil(count / MOST_LINES)))
        if (ranking.place[row] < 0) line(row);
      context.stroke();
      const { rows } = ranking;
      const step = Math.max(1, Math.ceil(rows.length / MOST_LINES));
      const drawn = Math.ceil(rows.length / step);
      context.globalAlpha = Math.max(0.12, Math.min(0.8, 12 / Math.sqrt(drawn + 1)));
      context.beginPath();
      let shade = -1;
      // The first of the ranking are drawn last, so that they lie on top.
      for (let at = drawn - 1; at >= 0; at--) {
        const wanted = shadeOf(shareOfPlace(ranking, at * step));
        if (wanted !== shade) {
          context.stroke();
          context.beginPath();
          context.strokeStyle = colourOfShade(wanted, theme);
          shade = wanted;
        }
        line(rows[at * step]);
      }
      context.stroke();
      context.globalAlpha = 1;
      const marked = (name: string, width: number, row: number) => {
        if (row >= count) return;
        context.lineWidth = width;
        context.strokeStyle = colour(name);
        context.beginPath();
        line(row);
        context.stroke();
      };
      for (const row of pinnedRows(individuals, pins, name))
        if (ranking.place[row] >= 0) marked("--ink", 1.3, row);
      if (looking?.generation != null && looking.individual != null)
        marked(
          "--accent",
          2.4,
          (looking.generation - 1) * individuals.population + looking.individual,
        );
      drawAxes(context, ranges, colour);
      for (const [at, axis] of AXES.entries()) {
        const brush = brushes[axis.id];
        if (!brush) continue;
        const [low, high] = brush.map((value) =>
          y(Math.max(0, Math.min(1, shareOf(axis, ranges[at], value)))),
        );
        context.fillStyle = colour("--accent-soft");
        context.strokeStyle = colour("--accent");
        context.lineWidth = 1.2;
        context.fillRect(x(at) - 6, high, 12, Math.max(2, low - high));
        context.strokeRect(x(at) - 6, high, 12, Math.max(2, low - high));
      }
    };
    return drawSoon(draw);
  }, [individuals, brushes, ranking, ranges, theme, pins, name, looking]);

  const shareUnder = (event: React.PointerEvent) => {
    const box = canvas.current!.getBoundingClientRect();
    const share = (HEIGHT - EDGE.bottom - (event.clientY - box.top)) / (y(0) - y(1));
    return Math.max(0, Math.min(1, share));
  };
  const down = (event: React.PointerEvent) => {
    const px = event.clientX - canvas.current!.getBoundingClientRect().left;
    const axis = AXES.findIndex((_, at) => Math.abs(x(at) - px) < REACH);
    if (axis < 0) return;
    event.currentTarget.setPointerCapture(event.pointerId);
    setStroke({ axis, from: shareUnder(event) });
    unbrush(AXES[axis].id);
  };
  const move = (event: React.PointerEvent) => {
    if (!stroke) return;
    const axis = AXES[stroke.axis];
    const shares = [stroke.from, shareUnder(event)].sort((a, b) => a - b);
    if (shares[1] - shares[0] < 0.02) return;
    const [least, most] = shares.map((share) => valueAt(axis, ranges[stroke.axis], share));
    setBrush(axis.id, [least, most]);
  };
  const chosen = ranking.rows.length;
  return (
    <div className="scatter">
      <canvas
        ref={canvas}
        style={{ width: WIDTH, height: HEIGHT, cursor: "ns-resize" }}
        role="img"
        aria-label={`Parallel coordinates of ${inFull(individuals.springs.length)} individuals, ${inFull(chosen)} of them brushed, coloured by ${measureOf(sort).name.toLowerCase()}`}
        onPointerDown={down}
        onPointerMove={move}
        onPointerUp={() => setStroke(null)}
      />
      <p className="explain">
        {mask
          ? `${inFull(chosen)} of ${inFull(individuals.springs.length)} individuals. `
          : "Drag along an axis to brush it. "}
        {mask && (
          <button type="button" className="link" onClick={() => store.setState({ brushes: {} })}>
            Show all
          </button>
        )}
      </p>
      <div className="limits">
        {AXES.map((axis, at) => (
          <Limits key={axis.id} axis={axis} range={ranges[at]} />
        ))}
      </div>
    </div>
  );
}

/** The same brush, typed. */
function Limits({ axis, range }: { axis: Axis; range: Range }) {
  const brush = useStudio((state) => state.brushes[axis.id]);
  const set = (side: 0 | 1, text: string) => {
    const value = Number(text);
    const next: Range = [...(brush ?? range)];
    next[side] = text.trim() && Number.isFinite(value) ? value : range[side];
    if (next[0] === range[0] && next[1] === range[1]) unbrush(axis.id);
    else setBrush(axis.id, next);
  };
  const field = (side: 0 | 1, word: string) => (
    <input
      key={`${word} ${brush?.[side] ?? ""}`}
      aria-label={`${axis.name}, ${word}`}
      defaultValue={brush && brush[side] !== range[side] ? onAxis(axis, brush[side], 5) : ""}
      placeholder={onAxis(axis, range[side], 4)}
      onBlur={(event) => {
        if (event.target.value !== event.target.defaultValue)
          set(side, event.target.value.replaceAll(",", ""));
      }}
      onKeyDown={(event) => {
        if (event.key === "Enter") event.currentTarget.blur();
      }}
    />
  );
  return (
    <>
      <span>{axis.name}</span>
      {field(0, "at least")}
      {field(1, "at most")}
    </>
  );
}

/** A value of an axis for people; a brush may end between two counts. */
function onAxis({ counts }: Axis, value: number, digits: number): string {
  return counts && Number.isInteger(value) ? inFull(value) : inDigits(value, digits);
}

function setBrush(axis: string, brush: Range): void {
  store.setState(({ brushes }) => ({ brushes: { ...brushes, [axis]: brush } }));
}

function unbrush(axis: string): void {
  store.setState(({ brushes: { [axis]: _, ...brushes } }) => ({ brushes }));
}

function drawAxes(
  context: CanvasRenderingContext2D,
  ranges: Range[],
  colour: (name: string) => string,
): void {
  context.font = "10px 'Inter Variable', sans-serif";
  context.textAlign = "center";
  AXES.forEach((axis, at) => {
    context.strokeStyle = colour("--line-strong");
    context.beginPath();
    context.moveTo(x(at), y(0));
    context.lineTo(x(at), y(1));
    context.stroke();
    context.fillStyle = colour("--soft");
    // The first name would be cut off by the edge.
    context.textAlign = at ? "center" : "left";
    context.fillText(axis.name, at ? x(at) : 2, at % 2 ? 9 : 19);
    context.textAlign = "center";
    context.fillStyle = colour("--faint");
    context.fillText(onAxis(axis, ranges[at][0], 4), x(at), HEIGHT - 5);
  });
}
