// How a run goes: force differential of the parent within its population, and springs, over generations.
import { useEffect, useRef } from "react";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Run } from "../document/run";
import { inFull } from "../document/scale";
import { useStudio } from "./use";

/** Steps between generations that have a number: whole ones. */
const GENERATIONS = [0, 1, 2, 3, 4, 5, 6].flatMap((power) => [1, 2, 5].map((n) => n * 10 ** power));

type Column = (number | null)[];

export function RunGraph({
  rows,
  of,
  own,
}: {
  rows: Run["rows"];
  of: "differential" | "springs";
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
        : [{}, { stroke: colour("--good"), width: 2, points: { show: false } }, start];
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
  const last = rows.at(-1);
  const words =
    of === "differential"
      ? `Force differential over ${inFull(rows.length)} generations, now ${last?.force_differential?.toFixed(2) ?? "undefined"}, at the start ${own?.toFixed(2) ?? "undefined"}`
      : `Springs over ${inFull(rows.length)} generations, now ${inFull(last?.springs ?? 0)}`;
  return <div className="graph" ref={box} role="img" aria-label={words} />;
}

function dataOf(
  rows: Run["rows"],
  of: "differential" | "springs",
  own: number | null,
): uPlot.AlignedData {
  const generations = rows.map(({ generation }) => generation);
  const column = (name: "low" | "median" | "high" | "force_differential" | "springs"): Column =>
    rows.map((row) => row[name]);
  const start: Column = rows.map(() => own);
  if (of === "springs") return [generations, column("springs"), start];
  return [
    generations,
    column("low"),
    column("high"),
    column("median"),
    column("force_differential"),
    start,
  ];
}
