// Evolution: its parameters, its course, all individuals, and what becomes of them.
import { Columns2, Images, Pause, Pin, PinOff, Play, Square } from "lucide-react";
import { useState } from "react";
import { compare } from "../document/comparing";
import { lookAt, pinOfSide, shownSide, togglePin } from "../document/pins";
import { inDigits } from "../document/scale";
import { ask, store } from "../document/store";
import { ClusterSection, LineageSection } from "./Choosing";
import { LiveSection } from "./LivePanel";
import { ParallelCoordinates } from "./ParallelCoordinates";
import { PinnedSection } from "./Pins";
import { Choice, Fact, IconButton, NumberField, Section } from "./parts";
import { RunGraph } from "./RunGraph";
import { Scatter } from "./Scatter";
import { RankLegend, SortControl } from "./Sorting";
import { useStudio } from "./use";

/** What a person may set; the rest has the engine's defaults. */
interface Form {
  population: number;
  generations: number;
  insertions: string;
  switches: string;
  toggles: string;
  types: string;
  weighting: string;
  fitness: string;
  selection: string;
  until_springs: number;
  seed: number;
}

const DEFAULTS: Omit<Form, "types"> = {
  population: 100,
  generations: 300,
  insertions: "3",
  switches: "3",
  toggles: "1",
  weighting: "exponential",
  fitness: "suf",
  selection: "comma",
  until_springs: 2000,
  seed: 1,
};

const TYPES: Record<string, string> = { recursive: "1", extensible: "1,2,3,4,5", dynamic: "1,6" };

/** Parameters that a run takes up while it goes on. */
const CHANGEABLE = [
  "generations",
  "insertions",
  "switches",
  "toggles",
  "types",
  "weighting",
  "fitness",
  "selection",
  "until_springs",
] as const;

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
  const kept = (run?.state.parameters ?? {}) as Partial<Record<keyof Form, unknown>>;
  const [form, setForm] = useState<Form>(() => formOf(kept, method));
  const set = (change: Partial<Form>) => setForm((before) => ({ ...before, ...change }));
  const alive = run?.state.status === "running" || run?.state.status === "paused";
  const start = () => {
    ask(
      {
        type: "evolve",
        looked: false,
        parameters: { ...form, until_springs: form.until_springs || null },
      },
      "Starting the run",
    );
  };
  const change = () => {
    const parameters = Object.fromEntries(
      CHANGEABLE.map((name) => [name, name === "until_springs" ? form[name] || null : form[name]]),
    );
    ask({ type: "steer_run", what: "change", parameters }, "Changing the parameters");
  };
  return (
    <Section title="Parameters">
      {!run || run.state.status === "none" ? (
        <p className="explain">
          Mutants of the net subdivide cells and change their types; the best of each generation is
          the parent of the next. Your design stays as it is until you take a net over.
        </p>
      ) : null}
      <NumberField
        label="Mutants a generation"
        value={form.population}
        least={1}
        whole
        onTake={(population) => set({ population })}
      />
      <AmountField
        label="Cells subdivided"
        value={form.insertions}
        onTake={(insertions) => set({ insertions })}
      />
      <AmountField
        label="Cells that change type"
        value={form.switches}
        onTake={(switches) => set({ switches })}
      />
      <AmountField
        label="Subdivisions turned off or on"
        value={form.toggles}
        onTake={(toggles) => set({ toggles })}
      />
      <AmountField
        label="Types that are drawn"
        value={form.types}
        onTake={(types) => set({ types })}
      />
      <Choice
        label="Cells are drawn"
        value={form.weighting}
        options={[
          { value: "unweighted", name: "evenly" },
          { value: "linear", name: "rather coarse ones" },
          { value: "exponential", name: "evenly by area" },
          { value: "deep", name: "rather fine ones" },
          { value: "stress", name: "by their force" },
        ]}
        onTake={(weighting) => set({ weighting })}
      />
      <Choice
        label="Best is the least"
        value={form.fitness}
        options={[
          { value: "suf", name: "spring utilization" },
          { value: "differential", name: "force differential" },
        ]}
        onTake={(fitness) => set({ fitness })}
      />
      <Choice
        label="The parent"
        value={form.selection}
        options={[
          { value: "comma", name: "always gives way" },
          { value: "plus", name: "stays while it is best" },
        ]}
        onTake={(selection) => set({ selection })}
      />
      <NumberField
        label="End at springs (0: never)"
        value={form.until_springs}
        least={0}
        whole
        onTake={(until_springs) => set({ until_springs })}
      />
      <NumberField
        label="End at generation"
        value={form.generations}
        least={1}
        whole
        onTake={(generations) => set({ generations })}
      />
      <NumberField
        label="Seed"
        value={form.seed}
        least={0}
        whole
        onTake={(seed) => set({ seed })}
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

function formOf(kept: Partial<Record<keyof Form, unknown>>, method: string): Form {
  const form: Form = { ...DEFAULTS, types: TYPES[method] ?? "1" };
  for (const name of Object.keys(form) as (keyof Form)[]) {
    const value = kept[name];
    if (name === "types" && Array.isArray(value)) form.types = value.join(",");
    else if (value !== undefined && value !== null && name !== "types")
      Object.assign(form, { [name]: value });
    else if (name === "until_springs" && value === null) form.until_springs = 0;
  }
  return form;
}

/** An amount such as 3 or 5%, or a list of types; the engine says what is wrong with it. */
function AmountField({
  label,
  value,
  onTake,
}: {
  label: string;
  value: string;
  onTake(value: string): void;
}) {
  return (
    <label className="number-field">
      <span>{label}</span>
      <input value={value} onChange={(event) => onTake(event.target.value)} />
    </label>
  );
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
    ["population", "seed", ...CHANGEABLE].flatMap((name) =>
      parameters[name] == null ? [] : [[name, parameters[name]]],
    ),
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
