// Evolution: its parameters, its course, all individuals, and what becomes of them.
import { Columns2, Images, Pause, Pin, PinOff, Play, Square } from "lucide-react";
import { useState } from "react";
import { compare } from "../document/comparing";
import { type ParameterName, type Texts, textOf, valueSaid } from "../document/parameters";
import { lookAt, pinOfSide, shownSide, togglePin } from "../document/pins";
import { inDigits } from "../document/scale";
import { ask, askQuietly, notify, store } from "../document/store";
import type { Asking, Refused } from "../protocol/connection";
import { ClusterSection, LineageSection } from "./Choosing";
import { LiveSection } from "./LivePanel";
import { ParallelCoordinates } from "./ParallelCoordinates";
import { ParameterFields } from "./ParameterFields";
import { PinnedSection } from "./Pins";
import { Fact, IconButton, Section } from "./parts";
import { RunGraph } from "./RunGraph";
import { Scatter } from "./Scatter";
import { RankLegend, SortControl } from "./Sorting";
import { useStudio } from "./use";

/** What a person may set; the rest has the engine's defaults. */
const SET = [
  "population",
  "insertions",
  "switches",
  "toggles",
  "types",
  "weighting",
  "fitness",
  "selection",
  "symmetry",
  "until_springs",
  "until_differential",
  "generations",
  "seed",
] as const satisfies ParameterName[];

const DEFAULTS: Texts = {
  population: "100",
  insertions: "3",
  switches: "3",
  toggles: "1",
  weighting: "exponential",
  fitness: "suf",
  selection: "comma",
  symmetry: "false",
  until_springs: "2000",
  until_differential: "0",
  generations: "300",
  seed: "1",
};

type Names = readonly ParameterName[];

const TYPES: Record<string, string> = { recursive: "1", extensible: "1,2,3,4,5", dynamic: "1,6" };

/** Those of them that a run keeps from its start. */
const FIXED: ParameterName[] = ["population", "seed"];

export function EvolvePanel() {
  const run = useStudio((state) => state.run);
  const status = run?.state.status ?? "none";
  return (
    <>
      <LiveSection />
      {run && status !== "none" && <Course />}
      <PinnedSection />
      {run && run.rows.length > 0 && (
        <Section title="Individuals" aside={<GalleryButton />}>
          <SortControl label="Sorted by" />
          <RankLegend />
          <Scatter />
          <ParallelCoordinates />
        </Section>
      )}
      <LineageSection />
      {run && run.rows.length > 0 && <ClusterSection />}
      <Parameters />
    </>
  );
}

function Course() {
  const run = useStudio((state) => state.run)!;
  const { status, reason, following, generations } = run.state;
  const last = run.rows.at(-1);
  const steer = (what: "pause" | "continue" | "stop") =>
    ask({ type: "steer_run", what, parameters: {} });
  const alive = status === "running" || status === "paused";
  return (
    <Section
      title="Run"
      aside={
        <span className={status === "failed" ? "aside bad" : "aside"}>{words(status, reason)}</span>
      }
    >
      <div className="row">
        {status === "running" ? (
          <button type="button" className="button icon" onClick={() => steer("pause")}>
            <Pause /> Pause
          </button>
        ) : (
          <button
            type="button"
            className="button icon primary"
            onClick={() => steer("continue")}
            disabled={status === "ended" && reason !== "it was stopped"}
          >
            <Play /> Continue
          </button>
        )}
        <button
          type="button"
          className="button icon"
          onClick={() => steer("stop")}
          disabled={!alive}
        >
          <Square /> Stop
        </button>
        <label className="check">
          <input
            type="checkbox"
            checked={following}
            onChange={(event) => ask({ type: "follow", on: event.target.checked })}
          />
          Follow in the view
        </label>
      </div>
      {run.state.driver && (
        <p className="explain">
          Driven by {run.state.driver}, which does what you ask between two generations.
        </p>
      )}
      {last && (
        <>
          <RunGraph rows={run.rows} of="differential" />
          <p className="graph-words">
            <i className="swatch accent" /> parent’s differential{" "}
            <b>{inDigits(last.force_differential, 4)}</b>
            <i className="swatch band" /> population
          </p>
          <RunGraph rows={run.rows} of="springs" />
          <p className="graph-words">
            <i className="swatch good" /> springs <b>{last.springs.toLocaleString("en")}</b>
          </p>
          <Fact name="Generations" value={generations} digits={6} />
          <Fact name="Spring utilization factor" value={last.suf} />
        </>
      )}
    </Section>
  );
}

function words(status: string, reason: string): string {
  if (status === "running") return "running";
  if (status === "paused") return "paused";
  return status === "failed" ? reason : `ended: ${reason}`;
}

function Parameters() {
  const method = useStudio((state) => state.document!.method);
  const run = useStudio((state) => state.run);
  const [texts, setTexts] = useState<Texts>(() => textsOf(run?.state.parameters ?? {}, method));
  const [problems, setProblems] = useState<Texts>({});
  const alive = run?.state.status === "running" || run?.state.status === "paused";
  const send = async (request: (values: Record<string, unknown>) => Asking, names: Names) => {
    const values = names.map((name) => [name, valueSaid(name, texts[name] ?? "")]);
    setProblems({});
    try {
      await askQuietly(request(Object.fromEntries(values)));
    } catch (error) {
      const { key, words } = error as Refused;
      if (names.includes(key as ParameterName)) setProblems({ [key as string]: words });
      else notify((error as Error).message);
    }
  };
  const start = () => send((parameters) => ({ type: "evolve", looked: false, parameters }), SET);
  const change = () =>
    send(
      (parameters) => ({ type: "steer_run", what: "change", parameters }),
      SET.filter((name) => !FIXED.includes(name)),
    );
  return (
    <Section title="Parameters">
      {!run || run.state.status === "none" ? (
        <p className="explain">
          Mutants of the net subdivide cells and change their types; the best of each generation is
          the parent of the next. Your design stays as it is until you take a net over.
        </p>
      ) : null}
      <ParameterFields
        names={SET}
        texts={texts}
        problems={problems}
        onTake={(name, text) => {
          setTexts((before) => ({ ...before, [name]: text }));
          setProblems((before) => ({ ...before, [name]: "" }));
        }}
      />
      <div className="row">
        <button type="button" className={alive ? "button" : "button primary"} onClick={start}>
          {run && run.state.status !== "none" ? "Start a new run" : "Evolve"}
        </button>
        {alive && (
          <button type="button" className="button" onClick={change}>
            Change from now on
          </button>
        )}
      </div>
    </Section>
  );
}

function textsOf(kept: Record<string, unknown>, method: string): Texts {
  const texts: Texts = { ...DEFAULTS, types: TYPES[method] ?? "1" };
  for (const name of SET) if (name in kept) texts[name] = textOf(name, kept[name]);
  return texts;
}

function GalleryButton() {
  const open = useStudio((state) => state.gallery);
  return (
    <button
      type="button"
      className="button icon"
      aria-pressed={open}
      onClick={() => store.setState({ gallery: !open })}
    >
      <Images /> {open ? "Hide pictures" : "Pictures"}
    </button>
  );
}

/** Parameters of a run for another one that goes on from one of its individuals. */
function changeableOf(parameters: Record<string, unknown>): Record<string, unknown> {
  return Object.fromEntries(
    SET.flatMap((name) => (parameters[name] == null ? [] : [[name, parameters[name]]])),
  );
}

/** Over the net, while something else than the design is shown. */
export function LookingBanner() {
  const looking = useStudio((state) => state.document?.looking ?? null);
  const figures = useStudio((state) => state.document?.figures);
  const run = useStudio((state) => state.run);
  const shown = useStudio((state) => shownSide(state.document));
  const pinned = useStudio((state) => pinOfSide(state, shown) !== null);
  if (!looking || !figures) return null;
  return (
    <div className="looking" role="status">
      <span>
        <b>{looking.label}</b>
        {figures.springs.toLocaleString("en")} springs, force differential{" "}
        {inDigits(figures.force_differential, 4)}
      </span>
      <button
        type="button"
        className="button primary"
        onClick={() => ask({ type: "reinstate" }, "Taking it over")}
      >
        Take over as my design
      </button>
      <button
        type="button"
        className="button"
        onClick={() =>
          ask(
            { type: "evolve", looked: true, parameters: changeableOf(run?.state.parameters ?? {}) },
            "Starting the run",
          )
        }
      >
        Breed from this
      </button>
      <button type="button" className="button" onClick={() => lookAt("design")}>
        Back to my design
      </button>
      <IconButton
        label={pinned ? "Unpin it" : "Pin it"}
        keys="P"
        pressed={pinned}
        onClick={() => togglePin(shown)}
      >
        {pinned ? <PinOff /> : <Pin />}
      </IconButton>
      <IconButton
        label="Compare with my design"
        keys="Shift+P"
        onClick={() => compare("design", shown)}
      >
        <Columns2 />
      </IconButton>
    </div>
  );
}
