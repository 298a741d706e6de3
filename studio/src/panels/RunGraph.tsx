// How a run goes: what its parent is within its population, over generations.
import { useEffect, useRef } from "react";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Run } from "../document/run";
import { inDigits, inFull } from "../document/scale";
import { useStudio } from "./use";

/** Steps between generations that have a number: whole ones. */
const GENERATIONS = [0, 1, 2, 3, 4, 5, 6].flatMap((power) => [1, 2, 5].map((n) => n * 10 ** power));

type Column = (number | null)[];

/** What is drawn over generations. */
type Of = "differential" | "springs" | "suf";

/** Colours of lines that stand alone. */
const LINES: Record<Exclude<Of, "differential">, string> = { springs: "--good", suf: "--second" };

export function RunGraph({
  rows,
  of,
  own,
}: {
  rows: Run["rows"];
  of: Of;
  /** Value of the design that it started from, drawn as a line. */
  own: number | null;
}) {
  const box = useRef<HTMLDivElement>(null);
  const plot = useRef<uPlot | null>(null);
  const theme = useStudio((state) => state.theme);
  const marks = useRef<number[]>([]);
  // biome-ignore lint/correctness/useExhaustiveDependencies: made anew when the colours of the page change
  useEffect(() => {
    const styles = getComputedStyle(document.documentElement);
    const colour = (name: string) => styles.getPropertyValue(name).trim();
    const axis = {
      stroke: colour("--faint"),
      grid: { stroke: colour("--line"), width: 1 },
      ticks: { show: false },
      font: "11px 'Inter Variable', sans-serif",
    };
    const band = (width: number) => ({
      stroke: colour("--line-strong"),
      width,
      points: { show: false },
    });
    const start = { stroke: colour("--soft"), width: 1, dash: [6, 4], points: { show: false } };
    const series: uPlot.Series[] =
      of === "differential"
        ? [
            {},
            band(0),
            band(0),
            { ...band(1), dash: [3, 3] },
            { stroke: colour("--accent"), width: 2, points: { show: false } },
            start,
          ]
        : [{}, { stroke: colour(LINES[of]), width: 2, points: { show: false } }, start];
    const made = new uPlot(
      {
        width: box.current!.clientWidth,
        height: of === "differential" ? 150 : 96,
        series,
        bands:
          of === "differential" ? [{ series: [2, 1], fill: `${colour("--line-strong")}66` }] : [],
        scales: { x: { time: false } },
        axes: [
          { ...axis, size: 22, incrs: GENERATIONS },
          { ...axis, size: 40 },
        ],
        legend: { show: false },
        cursor: { show: false },
        padding: [8, 14, 0, 0],
        hooks: {
          draw: [
            ({ ctx, bbox, valToPos }) => {
              ctx.save();
              ctx.strokeStyle = colour("--warn");
              ctx.setLineDash([2, 3]);
              for (const mark of marks.current) {
                const x = valToPos(mark, "x", true);
                ctx.beginPath();
                ctx.moveTo(x, bbox.top);
                ctx.lineTo(x, bbox.top + bbox.height);
                ctx.stroke();
              }
              ctx.restore();
            },
          ],
        },
      },
      [[]],
      box.current!,
    );
    plot.current = made;
    made.setData(dataOf(rows, of, own));
    return () => made.destroy();
  }, [theme, of]);
  useEffect(() => {
    marks.current = rows.filter(({ changed }) => changed).map(({ generation }) => generation);
    plot.current?.setData(dataOf(rows, of, own));
  }, [rows, of, own]);
  return <div className="graph" ref={box} role="img" aria-label={described(rows, of, own)} />;
}

function described(rows: Run["rows"], of: Of, own: number | null): string {
  const last = rows.at(-1);
  const over = `over ${inFull(rows.length)} generations, now`;
  if (of === "springs") return `Springs ${over} ${inFull(last?.springs ?? 0)}`;
  if (of === "suf") return `Spring utilization factor ${over} ${inDigits(last?.suf, 4)}`;
  const fixed = (value: number | null | undefined) => value?.toFixed(2) ?? "undefined";
  return `Force differential ${over} ${fixed(last?.force_differential)}, at the start ${fixed(own)}`;
}

function dataOf(rows: Run["rows"], of: Of, own: number | null): uPlot.AlignedData {
  const generations = rows.map(({ generation }) => generation);
  type Value = "low" | "median" | "high" | "force_differential" | "springs" | "suf";
  const column = (name: Value): Column => rows.map((row) => row[name]);
  const start: Column = rows.map(() => own);
  if (of !== "differential") return [generations, column(of), start];
  return [
    generations,
    column("low"),
    column("high"),
    column("median"),
    column("force_differential"),
    start,
  ];
}
