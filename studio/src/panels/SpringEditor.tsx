// What springs are made of: law, unstressed length, sense and section of some of them, said in one action.
import { X } from "lucide-react";
import { type FormEvent, useState } from "react";
import { notEditable } from "../document/editable";
import { LAWS, type LawKey, SENSES, shared } from "../document/laws";
import { groupOf, type Net } from "../document/net";
import { lengthsOf } from "../document/quantities";
import { inDigits, inFull } from "../document/scale";
import { selectedRows, springKey } from "../document/selection";
import { ask, notify, type State, store } from "../document/store";
import { CurveField, pointsOf } from "./CurveField";
import { Choice, Hint, Section } from "./parts";
import { useStudio } from "./use";

/** Some springs, as design files choose them. */
interface Scope {
  id: string;
  name: string;
  explains: string;
  choice: { parts?: string[]; along?: string[]; pairs?: string[] };
  rows: number[];
}

export function SpringEditor() {
  const net = useStudio((state) => state.net);
  const selection = useStudio((state) => state.selection);
  const position = useStudio((state) => state.document!.position);
  const ready = useStudio((state) => state.motion?.header.revision === state.net?.revision);
  const [wanted, setWanted] = useState("selection");
  if (!net || !ready) return null;
  const scopes = scopesOf(net, selection);
  const scope = scopes.find(({ id }) => id === wanted) ?? scopes[0];
  return (
    <Section title="Springs">
      <Choice
        label="Of"
        value={scope.id}
        options={scopes.map(({ id, name, explains }) => ({ value: id, name, explains }))}
        onTake={setWanted}
      />
      <LawForm
        key={`${scope.id} ${scope.rows.length} ${scope.rows[0]} ${position}`}
        scope={scope}
      />
      <Groups />
    </Section>
  );
}

function scopesOf(net: Net, selection: State["selection"]): Scope[] {
  const scopes: Scope[] = [];
  const chosen = new Set(selectedRows(net, selection, "springs"));
  for (const cell of selectedRows(net, selection, "cells"))
    for (const spring of groupOf(net.own, cell)) chosen.add(spring);
  const rods = (spring: number) => LAWS[net.law[spring]].key === "rod";
  const pick = (test: (spring: number) => boolean) =>
    [...net.law.keys()].filter((spring) => !rods(spring) && test(spring));
  const rows = pick((spring) => chosen.has(spring));
  if (rows.length)
    scopes.push({
      id: "selection",
      name:
        rows.length === 1 ? "the selected spring" : `the ${inFull(rows.length)} selected springs`,
      explains: "springs that are selected, and those of selected cells",
      choice: { pairs: rows.map((row) => springKey(net, row)) },
      rows,
    });
  scopes.push({
    id: "all",
    name: "all springs",
    explains: "the whole net, also what comes later",
    choice: {},
    rows: pick(() => true),
  });
  if (net.parts[0] !== "mesh")
    net.parts.forEach((part, number) => {
      scopes.push({
        id: `part ${part}`,
        name: part,
        explains: "all springs of this part, also what comes later",
        choice: { parts: [part] },
        rows: pick((spring) => net.springPart[spring] === number),
      });
    });
  const ring = pick((spring) => net.springRing[spring] === 1);
  if (ring.length)
    scopes.push({
      id: "ring",
      name: "free rings",
      explains: "springs along rings and rims that are not joined",
      choice: { along: ["ring"] },
      rows: ring,
    });
  return scopes;
}

/** What differs among springs, and is left so. */
const MIXED = {
  value: "" as const,
  name: "mixed",
  explains: "these springs differ, and keep theirs",
};

const RESTS = {
  rest_ratio: {
    name: "× drawn length",
    explains: "so many times as long as each spring was drawn",
    label: "L0",
    unit: "",
    value: "0.8",
  },
  rest_length: {
    name: "length",
    explains: "the same for all of them",
    label: "L0",
    unit: "m",
    value: "",
  },
  prestress: {
    name: "from prestress",
    explains: "such that each pulls with this force at its drawn length",
    label: "Force at the drawn length",
    unit: "N",
    value: "",
  },
};
type RestKey = keyof typeof RESTS;

function LawForm({ scope }: { scope: Scope }) {
  const { net, motion } = store.getState() as { net: Net; motion: NonNullable<State["motion"]> };
  const { rows } = scope;
  const refused = useStudio(notEditable);
  const number = shared(rows, (row) => net.law[row]);
  const known = number === null ? null : LAWS[number];
  const rest = shared(rows, (row) => net.restLength[row]);
  const value = known && shared(rows, (row) => known.value(net, row));
  const [law, setLaw] = useState<LawKey | "">((known?.key as LawKey) ?? "");
  const held = value === null || known?.key === "curve" ? "" : plain(value);
  const [constant, setConstant] = useState(held);
  const [restKey, setRestKey] = useState<RestKey | "">("");
  const [restValue, setRestValue] = useState("");
  const knownSense = shared(rows, (row) => net.sense[row]);
  const heldSense = knownSense === null ? "" : SENSES[knownSense].key;
  const [sense, setSense] = useState(heldSense);
  const [diameter, setDiameter] = useState("");
  const chosen = LAWS.find(({ key }) => key === law);
  const newLaw = chosen && chosen !== known;
  const takeLaw = (key: LawKey | "") => {
    setLaw(key);
    setSense(key && key !== known?.key ? "tension" : heldSense);
    const mean = meansOf(net, motion, rows);
    if (!key || key === known?.key) setConstant(held);
    else setConstant(likely(key, mean.force, mean.length));
    const needsRest = (key === "axial_stiffness" || key === "curve") && !(rest && rest > 0);
    setRestKey(needsRest ? "rest_ratio" : "");
    setRestValue(needsRest ? RESTS.rest_ratio.value : "");
  };
  const submit = (event: FormEvent) => {
    event.preventDefault();
    // What is no number would be sent as nothing, which takes back what was said.
    const given = [
      ...(chosen && chosen.key !== "curve" ? [[chosen.constant.name, constant]] : []),
      ...(restKey ? [[RESTS[restKey].label, restValue]] : []),
      ["The diameter", diameter],
    ];
    const wrong = given.find(([, text]) => text.trim() !== "" && !Number.isFinite(numberOf(text)));
    if (wrong) {
      notify(`${wrong[0]}: “${wrong[1].trim()}” is no number; write one such as 0.8`);
      return;
    }
    const positive = chosen && chosen.key !== "curve" && chosen.key !== "force";
    if (positive && constant.trim() !== "" && numberOf(constant) <= 0) {
      notify(`${chosen.constant.name}: must be greater than 0, not ${constant.trim()}`);
      return;
    }
    const says: Record<string, unknown> = {};
    if (law && (newLaw || constant !== held))
      says[law] = law === "curve" ? pointsOf(constant) : numberOf(constant);
    if (restKey && chosen?.elastic !== false) says[restKey] = numberOf(restValue);
    // Springs that are given a law pull only unless said; what the form shows is what counts.
    if (sense && (says[law] !== undefined || sense !== heldSense)) says.sense = sense;
    if (diameter.trim()) says.diameter = numberOf(diameter) / 1000;
    ask({ type: "set_springs", choice: fullChoice(scope.choice), says }, "Changing the springs");
  };
  return (
    <form className="law-form" onSubmit={submit}>
      <Choice
        label="Law"
        value={law}
        options={[
          ...(law === "" ? [MIXED] : []),
          ...LAWS.filter(({ key }) => key !== "rod").map(({ key, name, formula, explains }) => ({
            value: key as LawKey,
            name,
            explains: `${formula}. ${explains}`,
          })),
        ]}
        onTake={takeLaw}
      />
      {chosen && (
        <p className="formula">
          <code>{chosen.formula}</code>
          <span>{chosen.explains}</span>
        </p>
      )}
      {chosen?.key === "curve" ? (
        <CurveField text={constant} empty={newLaw ? "" : "as it is"} onText={setConstant} />
      ) : (
        chosen && (
          <Quantity
            label={`${chosen.constant.name} ${chosen.constant.symbol}`}
            unit={chosen.constant.unit}
            text={constant}
            empty="mixed"
            onText={setConstant}
          />
        )
      )}
      {chosen?.elastic && (
        <>
          <Choice
            label="Unstressed L0"
            value={restKey}
            options={[
              rest === null
                ? MIXED
                : { value: "" as const, name: `${inDigits(rest, 4)} m`, explains: "as it is now" },
              ...(Object.keys(RESTS) as RestKey[])
                .filter((key) => key !== "prestress" || chosen.key !== "curve")
                .map((key) => ({
                  value: key,
                  name: RESTS[key].name,
                  explains: RESTS[key].explains,
                })),
            ]}
            onTake={(key) => {
              setRestKey(key);
              setRestValue(key ? RESTS[key].value : "");
            }}
          />
          {restKey && (
            <Quantity
              label={RESTS[restKey].label}
              unit={RESTS[restKey].unit}
              text={restValue}
              empty=""
              onText={setRestValue}
            />
          )}
        </>
      )}
      <Choice
        label="Sense"
        value={sense}
        options={[
          ...(sense === "" ? [MIXED] : []),
          ...SENSES.map(({ key, name, explains }) => ({ value: key, name, explains })),
        ]}
        onTake={setSense}
      />
      <Quantity
        label="Diameter ⌀"
        unit="mm"
        text={diameter}
        empty={diameterOf(net, rows)}
        onText={setDiameter}
      />
      <div className="row end">
        <button
          type="submit"
          className="button primary"
          disabled={refused !== null}
          title={refused ?? undefined}
        >
          Apply to {scope.name}
        </button>
      </div>
    </form>
  );
}

/** A number that is typed and taken with the form. */
function Quantity({
  label,
  unit,
  text,
  empty,
  onText,
}: {
  label: string;
  unit: string;
  text: string;
  /** What stands in the empty field. */
  empty: string;
  onText(text: string): void;
}) {
  return (
    <label className="number-field">
      <span>{label}</span>
      <input
        inputMode="decimal"
        value={text}
        placeholder={empty}
        aria-invalid={text.trim() !== "" && !Number.isFinite(numberOf(text))}
        onChange={(event) => onText(event.target.value)}
      />
      <span className="unit">{unit}</span>
    </label>
  );
}

/** What is said of some springs, in order. */
function Groups() {
  const groups = useStudio((state) => state.document!.spring_groups);
  const stiffness = useStudio((state) => state.document!.stiffness);
  const factor = useStudio((state) => state.document!.ring_factor);
  return (
    <ol className="groups" aria-label="What is said of springs; the last word counts">
      <li>
        <b>unless said</b>
        <span>
          k = {inDigits(stiffness)} N/m
          {factor !== 1 && `, × ${inDigits(factor)} on free rings`}
        </span>
      </li>
      {groups.map(({ title, says }, number) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: a group has no name but its place
        <li key={number}>
          <b>{title}</b>
          <span>{says}</span>
          <Hint text={`Take back what is said of ${title}`} side="left">
            <button
              type="button"
              className="icon-button small"
              aria-label={`Take back: ${title}`}
              onClick={() => ask({ type: "drop_springs", group: number }, "Taking back")}
            >
              <X />
            </button>
          </Hint>
        </li>
      ))}
    </ol>
  );
}

function fullChoice(choice: Scope["choice"]) {
  return { parts: null, types: null, levels: null, along: null, pairs: null, ...choice };
}

function meansOf(net: Net, motion: NonNullable<State["motion"]>, rows: number[]) {
  const lengths = lengthsOf(net, motion);
  const mean = (values: Float32Array) =>
    rows.reduce((sum, row) => sum + values[row], 0) / rows.length;
  return { force: mean(motion.forces), length: mean(lengths) };
}

/** A constant with which springs carry about what they carry now. */
function likely(key: LawKey, force: number, length: number): string {
  const carried = Math.abs(force) > 1e-6 ? Math.abs(force) : 1;
  const ratio = Number(RESTS.rest_ratio.value);
  if (key === "curve") return `0, 0\n0.25, ${plain(carried, 3)}\n0.5, ${plain(1.6 * carried, 3)}`;
  if (key === "force") return plain(carried, 3);
  if (key === "axial_stiffness") return plain((carried * ratio) / (1 - ratio), 3);
  return plain(carried / length, 3);
}

function plain(value: number, digits = 6): string {
  return String(Number(value.toPrecision(digits)));
}

function numberOf(text: string): number {
  return text.trim() === "" ? Number.NaN : Number(text.trim().replace(",", "."));
}

function diameterOf(net: Net, rows: number[]): string {
  const area = shared(rows, (row) => net.area[row]);
  if (area === null) return "mixed";
  return area > 0 ? plain(2000 * Math.sqrt(area / Math.PI), 4) : "unknown";
}
