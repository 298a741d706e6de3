// What the colours mean, and the choice of what they show.
import { SlidersHorizontal } from "lucide-react";
import { Popover } from "radix-ui";
import { useMemo, useRef } from "react";
import {
  type Colouring,
  colouringOf,
  type KindLegend,
  type ScaleLegend,
} from "../document/colouring";
import { type Condition, type Conditions, PIECES } from "../document/conditions";
import { formulaOf, shared } from "../document/laws";
import {
  brokenColour,
  cssColour,
  cssGradient,
  noneColour,
  PALETTES,
  slackColour,
} from "../document/palettes";
import {
  formulaText,
  KINDS,
  QUANTITIES,
  type Quantity,
  type QuantityId,
  quantityOf,
} from "../document/quantities";
import { inDigits, inFull, type RangeMode, valueAt } from "../document/scale";
import { changeColour } from "../document/store";
import { largestReaction } from "../viewport/arrows";
import { Choice, Hint, NumberField, type Option } from "./parts";
import { useCalmMotion, useStudio } from "./use";

/** A quantity as a choice of what colours show. */
export function quantityOption({ id, name, explains, unit }: Quantity): Option<QuantityId> {
  return { value: id, name, explains: unit ? `${explains}, in ${unit}` : explains };
}

export function Legend() {
  const motion = useCalmMotion();
  const net = useStudio((state) => state.net);
  const colour = useStudio((state) => state.view.colour);
  const theme = useStudio((state) => state.theme);
  const colouring = useMemo(
    () =>
      net && motion && motion.header.revision === net.revision
        ? colouringOf(net, motion, colour, theme)
        : null,
    [net, motion, colour, theme],
  );
  // While nets follow one another, as in live evolution, that of the last one stays.
  const last = useRef<Colouring | null>(null);
  last.current = colouring ?? last.current;
  if (!net || !last.current) return null;
  const { legend, conditions } = last.current;
  const quantity = quantityOf(colour.by);
  return (
    <section className="floating legend" aria-label="Legend">
      <header>
        <Choice
          label="Colour springs by"
          hidden
          value={colour.by}
          options={[
            ...QUANTITIES.filter(
              ({ id, applies }) => id === colour.by || !applies || applies(net),
            ).map(quantityOption),
            ...KINDS.map(({ id, name, explains }) => ({ value: id, name, explains })),
          ]}
          onTake={(by: QuantityId) => changeColour({ by })}
        />
        {quantity && <ScaleSettings legend={legend as ScaleLegend} />}
      </header>
      {legend.shows === "scale" ? <ScaleBar legend={legend} /> : <KindList legend={legend} />}
      <Idle conditions={conditions} kinds={legend.shows === "kinds"} />
      <Arrow />
    </section>
  );
}

function ScaleBar({ legend }: { legend: ScaleLegend }) {
  const colour = useStudio((state) => state.view.colour);
  const theme = useStudio((state) => state.theme);
  const { scale, least, most, none } = legend;
  const quantity = quantityOf(colour.by)!;
  const unit = quantity.unit && ` ${quantity.unit}`;
  const net = useStudio((state) => state.net)!;
  const law = shared(net.law, (number) => number);
  const one = quantity.id === "force" && law !== null && net.law.length > 0;
  const formula = one ? formulaOf(net, 0) : formulaText(quantity);
  const below = least < scale.low * (1 - 1e-6);
  const above = most > scale.high * (1 + 1e-6);
  return (
    <>
      <div className="scale-bar" style={{ background: cssGradient(colour.palette, theme) }} />
      <div className="scale-ticks">
        <span data-testid="legend-low">
          {below && "≤ "}
          {inDigits(scale.low)}
        </span>
        <span>{inDigits(valueAt(scale, 0.5))}</span>
        <span data-testid="legend-high">
          {above && "≥ "}
          {inDigits(scale.high)}
          {unit}
        </span>
      </div>
      <footer>
        <code>{formula}</code>
        <span>
          {[
            scale.logarithmic && "log",
            colour.mode === "percentile" && "5–95 %",
            colour.mode === "fixed" && "fixed",
          ]
            .filter(Boolean)
            .join(" · ")}
        </span>
      </footer>
      {none > 0 && (
        <Entry
          colour={cssColour(noneColour(theme))}
          name={`no ${quantity.name.toLowerCase()}`}
          count={none}
        />
      )}
    </>
  );
}

/** The springs that carry nothing, told by their form; by kinds they keep the colour of their kind. */
function Idle({ conditions, kinds }: { conditions: Conditions; kinds: boolean }) {
  const theme = useStudio((state) => state.theme);
  const { slack, broken } = conditions;
  const ink = (colour: string) => (kinds ? "currentColor" : colour);
  return (
    <>
      {slack > 0 && (
        <Entry
          colour={ink(cssColour(slackColour(theme)))}
          name={slack === 1 ? "slack spring" : "slack springs"}
          count={slack}
          form="slack"
        />
      )}
      {broken > 0 && (
        <Entry
          colour={ink(cssColour(brokenColour(theme)))}
          name="broken: no force"
          count={broken}
          form="broken"
        />
      )}
    </>
  );
}

/** What the arrows mean, while they are shown. */
function Arrow() {
  const shown = useStudio((state) => state.view.reactions);
  const motion = useCalmMotion();
  if (!shown || !motion) return null;
  return (
    <div className="legend-entry reaction-entry">
      <i />
      <span>longest reaction</span>
      <span>{inDigits(largestReaction(motion))} N</span>
    </div>
  );
}

function KindList({ legend }: { legend: KindLegend }) {
  return (
    <div className="kind-list">
      {legend.entries.map(({ name, colour, count }) => (
        <Entry key={name} colour={cssColour(colour)} name={name} count={count} />
      ))}
    </div>
  );
}

function Entry({
  colour,
  name,
  count,
  form,
}: {
  colour: string;
  name: string;
  count: number;
  form?: Condition;
}) {
  return (
    <div className="legend-entry">
      {form ? (
        <svg className="legend-form" viewBox="0 0 1 0.14" aria-hidden="true">
          {PIECES[form].map(([from, to]) => (
            <line key={from} x1={from} x2={to} y1={0.07} y2={0.07} stroke={colour} />
          ))}
        </svg>
      ) : (
        <i style={{ background: colour }} />
      )}
      <span>{name}</span>
      <span>{inFull(count)}</span>
    </div>
  );
}

const MODES: Option<RangeMode>[] = [
  { value: "full", name: "All values", explains: "from the least value to the largest" },
  {
    value: "percentile",
    name: "5th to 95th percentile",
    explains: "few extremes don’t take the colours from all others",
  },
  { value: "fixed", name: "Fixed", explains: "the same while the net changes" },
];

function ScaleSettings({ legend }: { legend: ScaleLegend }) {
  const colour = useStudio((state) => state.view.colour);
  const { low, high } = legend.scale;
  return (
    <Popover.Root>
      <Hint text="Scale and palette" side="top">
        <Popover.Trigger asChild>
          <button type="button" className="icon-button small" aria-label="Scale and palette">
            <SlidersHorizontal />
          </button>
        </Popover.Trigger>
      </Hint>
      <Popover.Portal>
        <Popover.Content
          className="popover"
          side="top"
          align="start"
          sideOffset={10}
          aria-label="Scale and palette"
        >
          <Choice
            label="Palette"
            value={colour.palette}
            options={PALETTES.map(({ id, name, explains }) => ({ value: id, name, explains }))}
            onTake={(palette) => changeColour({ palette })}
          />
          <Choice
            label="Range"
            value={colour.mode}
            options={MODES}
            onTake={(mode) =>
              changeColour(mode === "fixed" ? { mode, fixed: [low, high] } : { mode })
            }
          />
          {colour.mode === "fixed" && (
            <div className="row">
              <NumberField
                label="From"
                value={colour.fixed[0]}
                onTake={(from) => changeColour({ fixed: [from, colour.fixed[1]] })}
              />
              <NumberField
                label="To"
                value={colour.fixed[1]}
                onTake={(to) => changeColour({ fixed: [colour.fixed[0], to] })}
              />
            </div>
          )}
          <label className="check">
            <input
              type="checkbox"
              checked={colour.logarithmic}
              onChange={(event) => changeColour({ logarithmic: event.target.checked })}
            />
            Logarithmic
          </label>
        </Popover.Content>
      </Popover.Portal>
    </Popover.Root>
  );
}
