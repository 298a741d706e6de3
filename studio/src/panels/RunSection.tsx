// The run of the document: its course, what it is started with, and the runs before it.
import { Images, Pause, Play, Square } from "lucide-react";
import { type MouseEvent, useRef } from "react";
import { toast } from "sonner";
import { useStore } from "zustand";
import { useShallow } from "zustand/react/shallow";
import { mayContinue, type Run } from "../document/run";
import { inDigits, inFull } from "../document/scale";
import {
  changeRun,
  forgetProblem,
  SET,
  starting,
  startRun,
  steerRun,
  textsShown,
  typeParameter,
} from "../document/starting";
import { ask, store } from "../document/store";
import { ParameterFields } from "./ParameterFields";
import { Fact, Section } from "./parts";
import { RunGraph } from "./RunGraph";
import { useStudio } from "./use";

export function RunSection() {
  const run = useStudio((state) => state.run);
  const top = useRef<HTMLDivElement>(null);
  const { status, reason } = run?.state ?? { status: "none", reason: "" };
  const made = run && status !== "none" ? run : null;
  return (
    <div ref={top}>
      <Section
        title="Run"
        aside={
          made && (
            <span className={status === "failed" ? "aside bad" : "aside"}>
              {words(status, reason)}
            </span>
          )
        }
      >
        {made ? (
          <Course run={made} />
        ) : (
          <p className="explain">
            Mutants of the net subdivide cells and change their types; the best of each generation
            is the parent of the next. Your design stays as it is until you take a net over.
          </p>
        )}
        <Starting run={made} onStart={() => top.current?.scrollIntoView({ block: "start" })} />
        {made && made.state.runs.length > 1 && <Runs run={made} />}
      </Section>
    </div>
  );
}

/** All runs of the document; each can be shown again. */
function Runs({ run }: { run: Run }) {
  const { runs, name, status } = run.state;
  return (
    <>
      <h3 className="runs-title">Runs of this document</h3>
      <ul className="runs" aria-label="Runs of this document">
        {runs.map((one) => (
          <li key={one.number}>
            <button
              type="button"
              aria-pressed={one.name === name}
              title={
                one.name === name
                  ? "It is shown"
                  : `Show it again${status === "running" ? "; the run that goes on ends, and can be continued later" : ""}`
              }
              onClick={() => openRun(one.number)}
            >
              <b>{one.number ? `Run ${one.number}` : "Run elsewhere"}</b>
              <span>
                {inFull(one.generations)} generations, {inFull(one.springs)} springs, differential{" "}
                {inDigits(one.force_differential, 4)}
              </span>
              {one.name === name && <em>shown</em>}
            </button>
          </li>
        ))}
      </ul>
    </>
  );
}

/** Shows another run; one that goes on stands still meanwhile, which is told. */
async function openRun(number: number): Promise<void> {
  const { run } = store.getState();
  const opened = await ask({ type: "open_run", number }, "Opening the run");
  if (opened && run?.state.status === "running")
    toast.message("The run that went on stands still; show it again to continue it", {
      id: "done",
    });
}

/** Why the differential goes where it goes. */
function reading(start: number, now: number, parameters: Record<string, unknown>): string {
  if (parameters.fitness === "differential" && now <= start)
    return "The best has the least force differential: the net need not become denser.";
  if (now <= start) return "No springs have come yet.";
  const rise =
    "More springs share the same pull, so the smallest force falls and the differential rises while the net becomes denser";
  return parameters.fitness === "differential"
    ? `${rise}; of each generation the mutant with the least is chosen.`
    : `${rise}; the mutant with the least rise for a spring is chosen.`;
}

function Course({ run }: { run: Run }) {
  const { status, following, generations } = run.state;
  const { start_springs, start_differential } = run.state;
  const last = run.rows.at(-1);
  const alive = status === "running" || status === "paused";
  return (
    <>
      <div className="row">
        {/* Keys, so that a press on the one never reaches the other in its place. */}
        {status === "running" ? (
          <button
            key="pause"
            type="button"
            className="button icon"
            onClick={() => steerRun("pause")}
          >
            <Pause /> Pause
          </button>
        ) : (
          <button
            key="continue"
            type="button"
            className="button icon primary"
            onClick={() => steerRun("continue")}
            disabled={!mayContinue(run)}
          >
            <Play /> Continue
          </button>
        )}
        <button
          type="button"
          className="button icon"
          onClick={() => steerRun("stop")}
          disabled={!alive}
        >
          <Square /> Stop
        </button>
        <label className="check">
          <input
            type="checkbox"
            checked={following}
            onChange={(event) =>
              ask({ type: "follow", on: event.target.checked }, "Following the run")
            }
          />
          Follow in the view
        </label>
      </div>
      {last && <LookButton stands={status !== "running"} />}
      {run.state.driver && (
        <p className="explain">
          Driven by {run.state.driver}, which does what you ask between two generations.
        </p>
      )}
      {last && (
        <>
          <RunGraph rows={run.rows} of="differential" own={start_differential} />
          <p className="graph-words">
            <i className="swatch accent" /> parent’s differential{" "}
            <b>{inDigits(last.force_differential, 4)}</b>
            <i className="swatch band" /> population
            <i className="swatch own" /> start <b>{inDigits(start_differential, 4)}</b>
          </p>
          <RunGraph rows={run.rows} of="springs" own={start_springs} />
          <p className="graph-words">
            <i className="swatch good" /> springs <b>{inFull(last.springs)}</b>
          </p>
          <RunGraph rows={run.rows} of="suf" own={null} />
          <p
            className="graph-words"
            title="How much the force differential rose for every spring that came since the start; 0 or less: it did not rise"
          >
            <i className="swatch second" /> spring utilization factor <b>{inDigits(last.suf, 4)}</b>
          </p>
          <p className="explain">{reading(start_springs, last.springs, run.state.parameters)}</p>
          <Fact name="Generations" value={generations} count />
        </>
      )}
    </>
  );
}

/** Opens the gallery, which is what a run is for once it stands. */
function LookButton({ stands }: { stands: boolean }) {
  const open = useStudio((state) => state.gallery);
  return (
    <div className="row">
      <button
        type="button"
        className={stands && !open ? "button icon primary wide" : "button icon wide"}
        aria-pressed={open}
        onClick={() => store.setState({ gallery: !open })}
      >
        <Images /> {open ? "Hide the individuals" : "Look at individuals"}
      </button>
    </div>
  );
}

function words(status: string, reason: string): string {
  if (status === "running") return "running";
  if (status === "paused") return reason ? `paused: ${reason}` : "paused";
  return status === "failed" ? reason : `ended: ${reason}`;
}

/** What a run is started with and changed to, and the buttons that do so, always in reach. */
function Starting({ run, onStart }: { run: Run | null; onStart(): void }) {
  const { texts, problems, open: wanted } = useStore(starting);
  const shown = useStudio(useShallow((state) => textsShown(texts, state)));
  const alive = run?.state.status === "running" || run?.state.status === "paused";
  const open = wanted ?? !run;
  const start = async (event: MouseEvent) => {
    if (event.detail > 1) return;
    if (await startRun()) onStart();
  };
  return (
    <>
      <details
        className="parameter-fold"
        open={open}
        onToggle={({ currentTarget }) => {
          // It is also told, later, when the page opened or closed it.
          if (currentTarget.open !== open) starting.setState({ open: currentTarget.open });
        }}
      >
        <summary>Parameters of runs</summary>
        {open && (
          <ParameterFields
            names={SET}
            texts={shown}
            problems={problems}
            onTake={typeParameter}
            onMend={forgetProblem}
          />
        )}
      </details>
      <div className="row start-run">
        <button type="button" className={alive ? "button" : "button primary"} onClick={start}>
          {run ? "Start a new run" : "Evolve"}
        </button>
        {alive && open && (
          <button type="button" className="button" onClick={changeRun}>
            Change from now on
          </button>
        )}
      </div>
    </>
  );
}
