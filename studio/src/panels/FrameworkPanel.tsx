// The framework by form: cylinders, sheets, joins, grid and density; the net follows when it is applied.
import { Plus, X } from "lucide-react";
import { useEffect, useState } from "react";
import { ask, store } from "../document/store";
import { Choice, Fact, IconButton, NumberField, Section } from "./parts";
import { useStudio } from "./use";

interface Part {
  name: string;
  around?: number;
  across?: number;
  along: number;
}

interface Arc {
  ring: string;
  start: number;
  length: number;
}

interface Join {
  first: Arc;
  second: Arc;
  reversed: boolean;
  cord: boolean;
}

/** The framework as the design file holds it; what no field shows is passed on as it is. */
interface Framework {
  grid: "quad" | "dia";
  level: number;
  cylinders: Part[];
  sheets: Part[];
  joins: Join[];
  anchors: unknown[];
  mesh: { faces: unknown[] } | null;
}

export function FrameworkPanel() {
  const kept = useStudio((state) => state.document!.framework) as unknown as Framework;
  const [draft, setDraft] = useState(kept);
  const [problem, setProblem] = useState("");
  useEffect(() => {
    setDraft(kept);
    setProblem("");
  }, [kept]);
  const set = (change: Partial<Framework>) => setDraft((before) => ({ ...before, ...change }));
  const changed = JSON.stringify(draft) !== JSON.stringify(kept);
  const apply = async () => {
    const framework = draft as unknown as Record<string, unknown>;
    setProblem("");
    if (!(await ask({ type: "set_framework", framework }, "Building the framework"))) {
      setProblem(store.getState().notice?.text ?? "");
    }
  };
  return (
    <>
      {draft.mesh ? (
        <Section title="Mesh">
          <p className="explain">The cells lie as they were drawn, in a mesh of quads.</p>
          <Fact name="Quads" value={draft.mesh.faces.length} count />
        </Section>
      ) : (
        <>
          <Parts
            title="Cylinders"
            size="around"
            parts={draft.cylinders}
            onTake={(cylinders) => set({ cylinders })}
            name="cylinder"
          />
          <Parts
            title="Sheets"
            size="across"
            parts={draft.sheets}
            onTake={(sheets) => set({ sheets })}
            name="sheet"
          />
          <Joins framework={draft} onTake={(joins) => set({ joins })} />
        </>
      )}
      <Section title="Grid">
        {!draft.mesh && (
          <Choice
            label="Cells lie"
            value={draft.grid}
            options={[
              { value: "quad", name: "in rows (quad)", explains: "along and around the cylinders" },
              { value: "dia", name: "as diamonds (dia)", explains: "springs run slantwise" },
            ]}
            onTake={(grid) => set({ grid })}
          />
        )}
        <NumberField
          label="Level: every cell subdivided"
          value={draft.level}
          least={0}
          whole
          onTake={(level) => set({ level })}
        />
        <Fact name="Anchors" value={draft.anchors.length} count />
        <p className="explain">
          Anchors are moved in the view, and held or let go with the node that is selected.
        </p>
      </Section>
      <div className={changed ? "apply changed" : "apply"}>
        {problem && (
          <p className="problem" role="alert">
            {problem}
          </p>
        )}
        <p className="explain">Cells that no longer fit start anew. This can be undone.</p>
        <div className="row end">
          <button
            type="button"
            className="button"
            disabled={!changed}
            onClick={() => setDraft(kept)}
          >
            As it was
          </button>
          <button type="button" className="button primary" disabled={!changed} onClick={apply}>
            Apply
          </button>
        </div>
      </div>
    </>
  );
}

function Parts({
  title,
  name,
  size,
  parts,
  onTake,
}: {
  title: string;
  name: string;
  size: "around" | "across";
  parts: Part[];
  onTake(parts: Part[]): void;
}) {
  const change = (at: number, by: Partial<Part>) =>
    onTake(parts.map((part, place) => (place === at ? { ...part, ...by } : part)));
  const add = () => {
    let number = parts.length + 1;
    while (parts.some((part) => part.name === `${name}_${number}`)) number++;
    onTake([
      ...parts,
      { name: `${name}_${number}`, [size]: parts[0]?.[size] ?? 16, along: parts[0]?.along ?? 6 },
    ]);
  };
  return (
    <Section title={title} aside={<Add label={`Add a ${name}`} onClick={add} />}>
      {parts.length === 0 && <p className="explain">None.</p>}
      {parts.map((part, at) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: a part has no other name than the one that is being typed
        <div className="part-row" key={at}>
          <input
            aria-label={`Name of ${name} ${at + 1}`}
            value={part.name}
            onChange={(event) => change(at, { name: event.target.value })}
          />
          <NumberField
            label={size}
            value={part[size] ?? 0}
            least={1}
            whole
            onTake={(value) => change(at, { [size]: value })}
          />
          <NumberField
            label="along"
            value={part.along}
            least={1}
            whole
            onTake={(along) => change(at, { along })}
          />
          <IconButton
            label={`Remove ${part.name}`}
            side="left"
            onClick={() => onTake(parts.filter((_, place) => place !== at))}
          >
            <X />
          </IconButton>
        </div>
      ))}
    </Section>
  );
}

function Joins({ framework, onTake }: { framework: Framework; onTake(joins: Join[]): void }) {
  const { joins } = framework;
  const rings = [
    ...framework.cylinders.flatMap(({ name }) => [`${name}.start`, `${name}.end`]),
    ...framework.sheets.flatMap(({ name }) =>
      ["start", "end", "left", "right"].map((side) => `${name}.${side}`),
    ),
  ];
  const change = (at: number, by: Partial<Join>) =>
    onTake(joins.map((join, place) => (place === at ? { ...join, ...by } : join)));
  const add = () => {
    const arc = (ring: string): Arc => ({ ring, start: 0, length: 4 });
    onTake([
      ...joins,
      {
        first: arc(rings[1] ?? ""),
        second: arc(rings[2] ?? rings[0] ?? ""),
        reversed: false,
        cord: false,
      },
    ]);
  };
  return (
    <Section
      title="Joins"
      aside={<Add label="Add a join" onClick={add} disabled={rings.length < 2} />}
    >
      {joins.length === 0 && (
        <p className="explain">
          None. A join makes an arc of one ring the same as an arc of another.
        </p>
      )}
      {joins.map((join, at) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: joins have no names, only their order
        <fieldset className="join" key={at} aria-label={`Join ${at + 1}`}>
          <ArcFields
            name="first arc"
            arc={join.first}
            rings={rings}
            onTake={(first) => change(at, { first })}
          />
          <ArcFields
            name="second arc"
            arc={join.second}
            rings={rings}
            onTake={(second) => change(at, { second })}
          />
          <div className="join-flags">
            <label className="check">
              <input
                type="checkbox"
                checked={join.reversed}
                onChange={(event) => change(at, { reversed: event.target.checked })}
              />
              reversed
            </label>
            <label className="check">
              <input
                type="checkbox"
                checked={join.cord}
                onChange={(event) => change(at, { cord: event.target.checked })}
              />
              cord along it
            </label>
            <IconButton
              label={`Remove join ${at + 1}`}
              side="left"
              onClick={() => onTake(joins.filter((_, place) => place !== at))}
            >
              <X />
            </IconButton>
          </div>
        </fieldset>
      ))}
    </Section>
  );
}

function ArcFields({
  name,
  arc,
  rings,
  onTake,
}: {
  name: string;
  arc: Arc;
  rings: string[];
  onTake(arc: Arc): void;
}) {
  const known = rings.includes(arc.ring) ? rings : [arc.ring, ...rings];
  return (
    <div className="arc">
      <Choice
        label={`Ring of the ${name}`}
        hidden
        value={arc.ring}
        options={known.map((ring) => ({
          value: ring,
          name: ring,
          explains: rings.includes(ring)
            ? "an end of a cylinder, or a side of a sheet"
            : "not there",
        }))}
        onTake={(ring) => onTake({ ...arc, ring })}
      />
      <NumberField
        label="from"
        value={arc.start}
        least={0}
        whole
        onTake={(start) => onTake({ ...arc, start })}
      />
      <NumberField
        label="edges"
        value={arc.length}
        least={1}
        whole
        onTake={(length) => onTake({ ...arc, length })}
      />
    </div>
  );
}

function Add({
  label,
  onClick,
  disabled = false,
}: {
  label: string;
  onClick(): void;
  disabled?: boolean;
}) {
  return (
    <IconButton label={label} side="left" onClick={onClick} disabled={disabled}>
      <Plus />
    </IconButton>
  );
}
