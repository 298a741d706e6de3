// Live evolution: the net evolves before one's eyes; anchors are dragged and cells brushed meanwhile.
import { Check, Eraser, Pause, Play, Sprout, X } from "lucide-react";
import type { ReactNode } from "react";
import { useMemo, useState } from "react";
import {
  MAKING,
  PARAMETERS,
  type ParameterName,
  type Texts,
  textOf,
  valueSaid,
} from "../document/parameters";
import { inDigits, inFull } from "../document/scale";
import { ask, askQuietly, store } from "../document/store";
import { GROW, springsIn } from "../document/weights";
import type { Refused } from "../protocol/connection";
import type { GenerationRow, LiveState } from "../protocol/messages";
import { clearMarks, discardGrown, keepGrown } from "./confirming";
import { ParameterFields } from "./ParameterFields";
import { Fact, Section } from "./parts";
import { RunGraph } from "./RunGraph";
import { useStudio } from "./use";

/** Asks for a step of live evolution. */
function steerLive(what: "start" | "pause" | "continue"): void {
  ask({ type: "live_evolve", what, parameters: {} }, "Evolving");
}

export function LiveSection() {
  const live = useStudio((state) => state.live);
  const alive = live !== null && live.status !== "none";
  return (
    <Section title="Live" aside={alive ? <span className="aside">{rateOf(live)}</span> : undefined}>
      {alive ? (
        <Course live={live} />
      ) : (
        <>
          <p className="explain">
            The net evolves before your eyes. Drag anchors and brush cells meanwhile; your design
            stays as it is until you keep what grew.
          </p>
          <div className="row">
            <button
              type="button"
              className="button icon primary"
              onClick={() => steerLive("start")}
            >
              <Sprout /> Evolve live
            </button>
          </div>
        </>
      )}
      <Brushes />
      {live && <LiveParameters live={live} />}
    </Section>
  );
}

/** Parameters that live evolution takes up at once. */
const SET = [
  ...MAKING,
  "max_springs",
  "until_springs",
  "until_differential",
  "seed",
] as const satisfies ParameterName[];

/** A goal does not end it: it stands still there, and goes on when it is told to. */
const LABELS: Texts = {
  until_springs: "Pause at springs (0: never)",
  until_differential: "Pause at force differential (0: never)",
};

function LiveParameters({ live }: { live: LiveState }) {
  const [open, setOpen] = useState(false);
  const [problems, setProblems] = useState<Texts>({});
  const texts: Texts = Object.fromEntries(
    SET.map((name) => [name, textOf(name, live.parameters[name])]),
  );
  const take = async (name: ParameterName, text: string) => {
    let problem = "";
    try {
      const parameters = { [name]: valueSaid(name, text) };
      await askQuietly(
        { type: "live_evolve", what: "change", parameters },
        "Changing the parameters",
      );
    } catch (error) {
      problem = (error as Refused).words;
    }
    setProblems((before) => ({ ...before, [name]: problem }));
  };
  const changed = live.changed.length;
  return (
    <details className="parameter-fold" onToggle={(event) => setOpen(event.currentTarget.open)}>
      <summary>
        Parameters of live evolution
        {changed > 0 && <span className="aside">{changed} changed</span>}
      </summary>
      <p className="explain">Changes count from the next generation on.</p>
      {open && (
        <ParameterFields
          names={SET}
          texts={texts}
          problems={problems}
          labels={LABELS}
          onTake={take}
          onMend={(name) => setProblems((before) => ({ ...before, [name]: "" }))}
        />
      )}
      {changed > 0 && (
        <button
          type="button"
          className="link"
          onClick={() => {
            setProblems({});
            ask(
              { type: "live_evolve", what: "defaults", parameters: {} },
              "Changing the parameters",
            );
          }}
        >
          Back to the defaults
        </button>
      )}
    </details>
  );
}

function Course({ live }: { live: LiveState }) {
  const last = live.points.at(-1);
  const own = useStudio((state) => state.document!.own);
  const still = standstill(live);
  const limit = limitReached(live);
  return (
    <>
      <RunGraph rows={rowsOf(live)} of="differential" own={own.force_differential} />
      <p className="graph-words">
        <i className="swatch accent" /> force differential{" "}
        <b>{inDigits(last?.force_differential ?? null, 4)}</b>
        <i className="swatch own" /> my design <b>{inDigits(own.force_differential, 4)}</b>
      </p>
      <p className="explain">
        {limit !== null
          ? `The net has as many springs as are allowed (${inFull(limit)}): denser mutants can't become parents. Raise “${PARAMETERS.max_springs.label}” under Parameters for more.`
          : still > PATIENCE
            ? `No mutant was better in ${still < live.points.length ? still : `${still} or more`} generations; the parent stays. ${live.parameters.fitness === "differential" ? "Compared by spring utilization, nets may rise in differential while they become denser." : "Other parameters, or an anchor moved, set it going again."}`
            : live.parameters.fitness === "suf"
              ? "The differential rises while springs come, for they share the same pull; the best has the least rise for a spring."
              : "The best has the least force differential, however many springs it has."}
      </p>
      <Fact name="Generations" value={live.generation} count />
      <Fact name="Generations a second" value={live.rate} digits={3} />
      <Fact name="Springs" value={last?.springs ?? null} count />
    </>
  );
}

/** Generations without a better mutant after which it is told. */
const PATIENCE = 25;

/** Share of the springs allowed from which on hardly a mutant of a parent is allowed. */
const FULL = 0.98;

/** The limit on springs, if it is what holds it back. */
function limitReached({ points, parameters }: LiveState): number | null {
  const most = parameters.max_springs as number | null;
  return most !== null && (points.at(-1)?.springs ?? 0) >= FULL * most ? most : null;
}

/** Generations since the parent changed. */
function standstill({ points }: LiveState): number {
  const last = points.at(-1);
  if (!last) return 0;
  let first = points.length;
  while (
    first > 0 &&
    points[first - 1].springs === last.springs &&
    points[first - 1].force_differential === last.force_differential
  )
    first--;
  return points.length - 1 - first;
}

function Brushes() {
  const tool = useStudio((state) => state.tool);
  const brush = useStudio((state) => state.brush);
  const count = useStudio((state) => Object.keys(state.live?.weights ?? {}).length);
  const one = (factor: number | null, name: string, icon: ReactNode, tone: string) => (
    <button
      type="button"
      className="button icon"
      aria-pressed={tool === "weigh" && brush === factor}
      onClick={() => store.setState({ tool: "weigh", brush: factor })}
    >
      <span className={`brush ${tone}`}>{icon}</span> {name}
    </button>
  );
  return (
    <fieldset className="brushes">
      <legend>Brush cells</legend>
      {one(GROW, "Grow here", <Sprout />, "grow")}
      {one(0, "Keep out", <X />, "keep-out")}
      {one(null, "Erase", <Eraser />, "")}
      {count > 0 && (
        <p className="explain">
          {inFull(count)} brushed; what descends from them inherits it, in runs too. Marks stay with
          the document until they are cleared.{" "}
          <button type="button" className="link" onClick={clearMarks}>
            Clear marks
          </button>
        </p>
      )}
      {count > 0 && <Growth />}
    </fieldset>
  );
}

/** How much of the net stands where it is to grow, and where evolution is kept out. */
function Growth() {
  const net = useStudio((state) => state.net);
  const weights = useStudio((state) => state.live?.weights);
  const [grown, kept] = useMemo(() => {
    if (!net || !weights) return [null, null];
    return [springsIn(net, weights, true), springsIn(net, weights, false)];
  }, [net, weights]);
  const all = (net?.ends.length ?? 0) / 2;
  const words = (count: number) =>
    `${inFull(count)} of ${inFull(all)} (${((100 * count) / Math.max(all, 1)).toFixed(1)} %)`;
  return (
    <div className="growth">
      {grown && (
        <>
          <Fact name="Springs where it grows" value={words(grown.springs)} />
          <Fact name="Cells where it grows" value={grown.cells} count />
        </>
      )}
      {kept && <Fact name="Springs kept out of" value={words(kept.springs)} />}
    </div>
  );
}

/** Over the net, while it evolves. */
export function LiveBanner() {
  const live = useStudio((state) => state.live);
  if (!live || live.status === "none") return null;
  const last = live.points.at(-1);
  return (
    <div className="looking live" role="status">
      <span>
        <b>
          <i className={live.status === "running" ? "pulse" : "pulse still"} />
          Evolving live, generation {inFull(live.generation)}
        </b>
        {live.status === "failed"
          ? live.reason
          : `${live.reason || rateOf(live)} · ${inFull(last?.springs ?? 0)} springs, force differential ${inDigits(last?.force_differential ?? null, 4)}`}
      </span>
      {live.status === "running" && (
        <button type="button" className="button icon" onClick={() => steerLive("pause")}>
          <Pause /> Pause
        </button>
      )}
      {live.status === "paused" && (
        <button type="button" className="button icon" onClick={() => steerLive("continue")}>
          <Play /> Continue
        </button>
      )}
      <button type="button" className="button icon primary" onClick={keepGrown}>
        <Check /> Stop and keep
      </button>
      <button type="button" className="button" onClick={discardGrown}>
        Discard
      </button>
    </div>
  );
}

function rateOf(live: LiveState): string {
  return live.status === "running" ? `${live.rate.toFixed(0)} generations a second` : live.status;
}

function rowsOf({ points }: LiveState): GenerationRow[] {
  const unknown = { suf: null, winner: null, least: null, low: null, median: null, high: null };
  return points.map((point) => ({ ...unknown, ...point, changed: false }));
}
