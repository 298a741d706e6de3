// The net as a whole: its figures, before and after the last action, stress-seeking and settings.
import { useState } from "react";
import { springsOfType, typeName } from "../document/cellTypes";
import { differentialTells, figuresNow, springUtilization } from "../document/figures";
import { inFull } from "../document/scale";
import { ask } from "../document/store";
import { selectExtreme } from "./commands";
import { DensitySection } from "./DensitySection";
import { FilterSection } from "./FilterSection";
import { foreseen } from "./foreseen";
import { useGrafting } from "./GraftPanel";
import { Choice, Fact, NumberField, Section } from "./parts";
import { ReactionTable } from "./ReactionTable";
import { SelectionSections } from "./SelectionSections";
import { SpringEditor } from "./SpringEditor";
import { useCalmNet, useStudio } from "./use";

export function NetPanel() {
  return (
    <>
      <SelectionSections />
      <Figures />
      <SpringEditor />
      <StressSeeking />
      <DensitySection />
      <FilterSection />
      <ReactionTable />
      <Settings />
    </>
  );
}

/** Figures of the net that is seen while it is not the design at rest, and why not; null at rest. */
function useUnrest() {
  const { net, motion } = useCalmNet();
  const live = useStudio((state) => (state.live?.status ?? "none") !== "none");
  if (!net || !motion || motion.header.revision !== net.revision) return null;
  const { held, settled, running } = motion.header;
  if (!live && !held.length && (settled || running)) return null;
  const now = figuresNow(net, motion);
  const why = live
    ? "of what grew, against my design"
    : held.length
      ? "while pulled"
      : "while paused";
  return now && { now, why: live ? why : `${why}, against at rest` };
}

function Figures() {
  const { figures: rest, before: past, history, position } = useStudio((state) => state.document)!;
  const last = history.find(({ number }) => number === position);
  const unrest = useUnrest();
  const figures = unrest ? { ...rest, ...unrest.now } : rest;
  const before = unrest ? rest : past;
  const utilization = before && springUtilization(figures, before);
  const against = unrest ? unrest.why : past && last && `against before “${last.label}”`;
  return (
    <Section title="Figures" aside={against && <span className="aside">{against}</span>}>
      {!figures.converged && <p className="warning">No equilibrium: {figures.reason}</p>}
      <Fact
        name="Force differential"
        value={figures.force_differential}
        before={before?.force_differential}
        {...(differentialTells(figures, before) ? { better: "less" as const } : {})}
        title="Largest over smallest spring force: the nearer to 1, the sooner one kind of cord makes the net; undefined if a spring carries next to nothing"
      />
      <Fact name="Springs" value={figures.springs} before={before?.springs} count />
      {utilization !== null && (
        <Fact
          name="Spring utilization factor"
          value={utilization}
          title="How much the force differential rose for every spring that came: the less, the better; 0 or less: it did not rise"
        />
      )}
      <Fact
        name="Largest force"
        value={figures.force_max}
        unit="N"
        before={before?.force_max}
        title="Of all springs: click to select the one that carries it"
        onPick={selectExtreme(true)}
      />
      <Fact
        name="Smallest force"
        value={figures.force_min}
        unit="N"
        before={before?.force_min}
        title="Of all springs: click to select the one that carries it"
        onPick={selectExtreme(false)}
      />
      <Fact name="Mean force" value={figures.force_mean} unit="N" before={before?.force_mean} />
      <Fact
        name="Total length"
        value={figures.total_length}
        unit="m"
        before={before?.total_length}
      />
      <Fact
        name="Shortest spring"
        value={figures.shortest_spring}
        unit="m"
        before={before?.shortest_spring}
      />
      <Fact
        name="Area"
        value={unrest ? null : figures.area}
        unit="m²"
        before={unrest ? null : before?.area}
        title="Of all cells, at rest"
      />
    </Section>
  );
}

function StressSeeking() {
  const types = useStudio((state) => state.document!.cell_types);
  const [steps, setSteps] = useState(10);
  const [kind, setKind] = useState("1");
  const known = types.some(({ word }) => word === kind) ? kind : (types[0]?.word ?? "1");
  const orbit = useGrafting((state) => state.lock);
  const seek = (count: number) =>
    ask(
      { type: "seek_stress", steps: count, kind: known, orbit },
      `Seeking stress, ${inFull(count)} steps`,
    );
  return (
    <Section title="Stress-seeking">
      <p className="explain">
        Subdivides the cell that carries most{orbit && " and all that are like it (symmetry lock)"},
        solves, and does so again.
      </p>
      <Choice
        label="Type of the children"
        value={known}
        options={types.map(({ word }) => ({
          value: word,
          name: typeName(word),
          explains: springsOfType(word),
        }))}
        onTake={setKind}
      />
      <NumberField
        label="Steps"
        value={steps}
        least={1}
        whole
        onTake={(value) => setSteps(Math.min(value, 1000))}
      />
      <div className="row">
        <button
          type="button"
          className="button"
          {...foreseen("one step of stress-seeking", {
            type: "seek_stress",
            steps: 1,
            kind: known,
            orbit,
          })}
          onClick={() => seek(1)}
        >
          One step
        </button>
        <button type="button" className="button" onClick={() => seek(steps)}>
          {inFull(steps)} steps
        </button>
      </div>
    </Section>
  );
}

function Settings() {
  const { stiffness, ring_factor } = useStudio((state) => state.document)!;
  const set = (label: string, path: string[], value: unknown) =>
    ask({ type: "set_value", label, path, value }, label);
  return (
    <Section title="Springs without a law of their own">
      <NumberField
        label="Stiffness k, F = k L"
        value={stiffness}
        unit="N/m"
        least={1e-9}
        onTake={(value) => set("Change the stiffness", ["springs", "stiffness"], value)}
      />
      <NumberField
        label="Factor along free rings"
        value={ring_factor}
        least={1e-9}
        onTake={(value) => set("Change the ring factor", ["springs", "ring_factor"], value)}
      />
    </Section>
  );
}
