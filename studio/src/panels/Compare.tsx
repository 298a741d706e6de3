// Two nets side by side: which is which, the scale that both share, and their figures with differences.
import { ArrowLeftRight, Pin, PinOff, X } from "lucide-react";
import { useMemo } from "react";
import { typeName } from "../document/cellTypes";
import {
  setSide,
  sharedColour,
  sharedQuantity,
  stopComparing,
  swapSides,
} from "../document/comparing";
import { differentialTells } from "../document/figures";
import { cssGradient } from "../document/palettes";
import { labelOfSide, pinOfSide, type Side, shownSide, togglePin } from "../document/pins";
import { QUANTITIES, type QuantityId } from "../document/quantities";
import { inDigits, inFull, scaleOf, valueAt } from "../document/scale";
import { changeColour } from "../document/store";
import type { Compared, ComparedNet, PinState } from "../protocol/messages";
import { quantityOption } from "./Legend";
import { Choice, IconButton, type Option, Section } from "./parts";
import { useComparing, useStudio } from "./use";

const LETTERS = ["A", "B"] as const;

/** Over the canvas while two nets are compared. */
export function CompareOverlay() {
  const sides = useComparing((state) => state.sides);
  const nets = useComparing((state) => state.nets);
  if (!sides) return null;
  return (
    <section className="compare" aria-label="Two nets side by side">
      {([0, 1] as const).map((at) => (
        <div key={at} className="compare-half">
          <Heading at={at} side={sides[at]} />
          {!nets[at] && <p className="compare-wait">Rebuilding the net …</p>}
        </div>
      ))}
      <div className="compare-swap floating">
        <IconButton label="Swap the two nets" keys="S" side="bottom" onClick={swapSides}>
          <ArrowLeftRight />
        </IconButton>
      </div>
      <SharedLegend />
    </section>
  );
}

function Heading({ at, side }: { at: 0 | 1; side: Side }) {
  const net = useComparing((state) => (at ? state.table?.second : state.table?.first));
  const pinned = useStudio((state) => pinOfSide(state, side) !== null);
  return (
    <header className={`compare-heading floating side-${LETTERS[at].toLowerCase()}`}>
      <b className="letter-badge">{LETTERS[at]}</b>
      <div>
        <Choice
          label={`Net ${LETTERS[at]}`}
          hidden
          value={side}
          options={useSides(side)}
          onTake={(taken) => setSide(at, taken)}
        />
        <span>
          {net
            ? `${inFull(net.figures.springs)} springs, differential ${inDigits(net.figures.force_differential, 4)}`
            : "…"}
        </span>
      </div>
      <IconButton
        label={pinned ? `Unpin net ${LETTERS[at]}` : `Pin net ${LETTERS[at]}`}
        side="bottom"
        pressed={pinned}
        onClick={() => togglePin(side)}
      >
        {pinned ? <PinOff /> : <Pin />}
      </IconButton>
    </header>
  );
}

/** What can stand on a side: the design, what is shown, pins, and what stands there. */
function useSides(side: Side): Option<Side>[] {
  const pins = useStudio((state) => state.pins);
  const shown = useStudio((state) => shownSide(state.document));
  const both = useComparing((state) => state.sides);
  return useMemo(() => {
    const all = [
      "design",
      shown,
      side,
      ...(both ?? []),
      ...pins.map(({ number }) => `pin/${number}`),
    ];
    return [...new Set(all)].map((value) => ({
      value,
      name: `${value.startsWith("pin/") ? "Pinned: " : ""}${labelOfSide(pins, value)}`,
      explains: explained(pins, value),
    }));
  }, [pins, shown, side, both]);
}

function explained(pins: PinState[], side: Side): string {
  const pin = pins.find(({ number }) => side === `pin/${number}`);
  if (pin)
    return `${inFull(pin.figures.springs)} springs, differential ${inDigits(pin.figures.force_differential)}`;
  return side === "design" ? "as it is now" : "of the run, as it was made";
}

/** One scale for both nets. */
function SharedLegend() {
  const nets = useComparing((state) => state.nets);
  const colour = useStudio((state) => state.view.colour);
  const theme = useStudio((state) => state.theme);
  const quantity = sharedQuantity(colour);
  const scale = useMemo(
    () => scaleOf(new Float32Array(), sharedColour(nets, colour)),
    [nets, colour],
  );
  const options = QUANTITIES.filter(
    ({ id, applies }) =>
      id === quantity.id || !applies || nets.every((one) => one && applies(one.net)),
  );
  return (
    <section className="floating shared-legend" aria-label="Legend of both nets">
      <Choice
        label="Colour both nets by"
        hidden
        value={quantity.id}
        options={options.map(quantityOption)}
        onTake={(by: QuantityId) => changeColour({ by })}
      />
      <div>
        <div className="scale-bar" style={{ background: cssGradient(colour.palette, theme) }} />
        <div className="scale-ticks">
          <span data-testid="shared-low">{inDigits(scale.low)}</span>
          <span>{inDigits(valueAt(scale, 0.5))}</span>
          <span data-testid="shared-high">
            {inDigits(scale.high)} {quantity.unit}
          </span>
        </div>
      </div>
      <span className="shared-words">same scale for A and B</span>
    </section>
  );
}

interface Row {
  name: string;
  unit: string;
  value(net: ComparedNet): number | null;
  /** Whether less of it is better. */
  less?: boolean;
}

const DIFFERENTIAL = "Force differential";

const ROWS: Row[] = [
  { name: "Springs", unit: "", value: ({ figures }) => figures.springs },
  { name: "Nodes", unit: "", value: ({ figures }) => figures.nodes },
  { name: "Cells", unit: "", value: ({ figures }) => figures.cells },
  {
    name: DIFFERENTIAL,
    unit: "",
    value: ({ figures }) => figures.force_differential,
    less: true,
  },
  { name: "Largest force", unit: "N", value: ({ figures }) => figures.force_max, less: true },
  { name: "Smallest force", unit: "N", value: ({ figures }) => figures.force_min },
  { name: "Mean force", unit: "N", value: ({ figures }) => figures.force_mean },
  { name: "Deviation", unit: "N", value: (net) => net.force_deviation, less: true },
  { name: "Total length", unit: "m", value: ({ figures }) => figures.total_length },
  { name: "Shortest spring", unit: "m", value: ({ figures }) => figures.shortest_spring },
  { name: "Area", unit: "m²", value: ({ figures }) => figures.area },
  { name: "Load path", unit: "N m", value: (net) => net.load_path },
  { name: "Largest reaction", unit: "N", value: (net) => net.largest_reaction },
];

/** In place of the panels while two nets are compared. */
export function CompareTable() {
  const table = useComparing((state) => state.table);
  return (
    <aside className="inspector compare-table" aria-label="Figures of both nets">
      <header>
        <h2>Comparison</h2>
        <IconButton label="Close the comparison" keys="Escape" side="left" onClick={stopComparing}>
          <X />
        </IconButton>
      </header>
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: it scrolls by keys */}
      <section className="panel" tabIndex={0} aria-label="Figures, reactions and cells">
        {table ? (
          <Figures table={table} />
        ) : (
          <p className="explain">Both nets are being rebuilt and solved.</p>
        )}
      </section>
    </aside>
  );
}

function Figures({ table }: { table: Compared }) {
  const { first, second, changed, types, reactions } = table;
  const problems = [first, second].flatMap(({ figures }, at) =>
    figures.converged ? [] : [`Net ${LETTERS[at]} has no equilibrium: ${figures.reason}`],
  );
  return (
    <>
      <Section title="At equilibrium">
        {problems.map((problem) => (
          <p key={problem} className="warning">
            {problem}
          </p>
        ))}
        <Table
          caption="Figures"
          rows={ROWS.map(({ name, unit, value, less }) => ({
            name,
            unit,
            values: [value(first), value(second)],
            less:
              (less ?? false) &&
              (name !== DIFFERENTIAL || differentialTells(second.figures, first.figures)),
          }))}
        />
        <p className="explain">
          {changed === null
            ? "The nets have different frameworks."
            : changed === 0
              ? "No top-level cell differs."
              : `${inFull(changed)} top-level ${changed === 1 ? "cell differs" : "cells differ"}.`}
        </p>
      </Section>
      <Section title="Reactions" aside={<span className="aside">N, by anchor</span>}>
        <Table
          caption="Reactions by anchor"
          rows={reactions.map(({ anchor, first, second }) => ({
            name: anchor,
            unit: "",
            values: [first, second],
            less: false,
          }))}
        />
      </Section>
      <Section title="Cells by type">
        <Table
          caption="Cells by type"
          rows={types.map(({ name, first, second }) => ({
            name: `Type ${typeName(name)}`,
            unit: "",
            values: [first, second],
            less: false,
          }))}
        />
      </Section>
    </>
  );
}

interface Line {
  name: string;
  unit: string;
  values: [number | null, number | null];
  less: boolean;
}

function Table({ caption, rows }: { caption: string; rows: Line[] }) {
  return (
    <table className="comparison">
      <caption className="visually-hidden">{caption}</caption>
      <thead>
        <tr>
          <td />
          <th scope="col">A</th>
          <th scope="col">B</th>
          <th scope="col">B − A</th>
        </tr>
      </thead>
      <tbody>
        {rows.map(({ name, unit, values, less }) => {
          const [a, b] = values;
          const change = a === null || b === null ? null : b - a;
          const tone = less && change ? (change < 0 ? "good" : "bad") : "";
          return (
            <tr key={name}>
              <th scope="row">
                {name}
                {unit && <span className="unit"> {unit}</span>}
              </th>
              <td>{figure(a)}</td>
              <td>{figure(b)}</td>
              <td className={tone} title={a && change ? `${percent(change / a)} of A` : undefined}>
                {change === null ? "–" : signed(change, a!)}
              </td>
            </tr>
          );
        })}
      </tbody>
    </table>
  );
}

function figure(value: number | null): string {
  return Number.isInteger(value) ? inFull(value!) : inDigits(value, 4);
}

/** A change of a value; what rounding leaves over is none. */
function signed(change: number, value: number): string {
  if (Math.abs(change) <= 1e-9 * Math.abs(value)) return "0";
  const size = Number.isInteger(change) ? inFull(Math.abs(change)) : inDigits(Math.abs(change), 3);
  return `${change > 0 ? "+" : "−"}${size}`;
}

function percent(share: number): string {
  return `${share > 0 ? "+" : "−"}${inDigits(Math.abs(100 * share), 3)} %`;
}

/** Whether anything is compared. */
export function useIsComparing(): boolean {
  return useComparing((state) => state.sides !== null);
}
