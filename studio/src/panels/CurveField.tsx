// A measured force–strain curve: its points typed or read from a CSV file, and drawn.
import { FileUp } from "lucide-react";
import { useRef, useState } from "react";
import { inDigits } from "../document/scale";
import { orNotice } from "../document/store";
import { fetchCurve } from "../protocol/fetching";
import { Hint } from "./parts";

const WIDTH = 300;
const HEIGHT = 84;

export function CurveField({
  text,
  empty,
  onText,
}: {
  text: string;
  /** What stands in the empty field. */
  empty: string;
  onText(text: string): void;
}) {
  const [source, setSource] = useState("");
  const field = useRef<HTMLInputElement>(null);
  const load = async (file: File | undefined) => {
    if (!file) return;
    const curve = await orNotice(fetchCurve(file));
    if (!curve) return;
    onText(
      curve.strains.map((strain, at) => `${plain(strain)}, ${plain(curve.forces[at])}`).join("\n"),
    );
    setSource(file.name);
  };
  const points = pointsOf(text);
  return (
    <div className="curve-field">
      <label>
        <span>Points: strain, force in N; a line each, from 0, 0</span>
        <textarea
          rows={4}
          value={text}
          placeholder={empty}
          onChange={(event) => {
            setSource("");
            onText(event.target.value);
          }}
        />
      </label>
      <div className="row">
        <Hint
          text='The first row names the columns and their units, such as "strain [%],force [N]"'
          side="left"
        >
          <button type="button" className="button icon" onClick={() => field.current?.click()}>
            <FileUp /> Load a CSV file
          </button>
        </Hint>
        <input
          ref={field}
          type="file"
          accept=".csv,.tsv,.txt,text/csv"
          hidden
          aria-label="CSV file with a measured curve"
          onChange={(event) => {
            load(event.target.files?.[0]);
            event.target.value = "";
          }}
        />
        {source && (
          <span className="curve-source" role="status">
            {points.length} points of {source}
          </span>
        )}
      </div>
      <CurveSketch points={points} />
    </div>
  );
}

/** The curve as it will be understood: straight between the points. */
function CurveSketch({ points }: { points: number[][] }) {
  const whole =
    points.length > 1 && points.every((one) => one.length === 2 && one.every(Number.isFinite));
  if (!whole) return null;
  const [strains, forces] = [0, 1].map((at) => [0, ...points.map((point) => point[at])]);
  const [left, right] = [Math.min(...strains), Math.max(...strains)];
  const [low, high] = [Math.min(...forces), Math.max(...forces)];
  if (right === left || high === low) return null;
  const x = (strain: number) => 4 + ((strain - left) / (right - left)) * (WIDTH - 8);
  const y = (force: number) => HEIGHT - 4 - ((force - low) / (high - low)) * (HEIGHT - 8);
  const said = `Force against strain, up to ${inDigits(high)} N at a strain of ${inDigits(right)}`;
  return (
    <figure className="curve-sketch">
      <svg viewBox={`0 0 ${WIDTH} ${HEIGHT}`} role="img" aria-label={said}>
        <path className="axes" d={`M${x(0)} 0V${HEIGHT}M0 ${y(0)}H${WIDTH}`} />
        <polyline points={points.map(([e, f]) => `${x(e)},${y(f)}`).join(" ")} />
        {points.map(([strain, force]) => (
          <circle key={`${strain} ${force}`} cx={x(strain)} cy={y(force)} r={2.2} />
        ))}
      </svg>
      <figcaption>
        <span>F up to {inDigits(high)} N</span>
        <span>ε up to {inDigits(right)}</span>
      </figcaption>
    </figure>
  );
}

/** Points from lines of two numbers. */
export function pointsOf(text: string): number[][] {
  return text
    .split("\n")
    .filter((line) => line.trim())
    .map((line) =>
      line
        .trim()
        .split(/[\s,;]+/)
        .map(Number),
    );
}

function plain(value: number): string {
  return String(Number(value.toPrecision(9)));
}
