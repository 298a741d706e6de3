// Density: all cells of a cylinder, or of the net, one level finer or coarser, or brought to a level.
import { Minus, Plus } from "lucide-react";
import type { Net } from "../document/net";
import { forget } from "../document/previews";
import { ask } from "../document/store";
import { foreseen } from "./foreseen";
import { Hint, Section } from "./parts";
import { useStudio } from "./use";

const DEEPEST = 8;

export function DensitySection() {
  const net = useStudio((state) => state.net);
  if (!net) return null;
  const parts = net.parts[0] === "mesh" ? [] : net.parts;
  const rows = [{ part: null as string | null, name: "whole net", number: -1 }].concat(
    parts.length > 1 ? parts.map((part, number) => ({ part, name: part, number })) : [],
  );
  return (
    <Section title="Density" aside={<span className="aside">levels of cells</span>}>
      {rows.map(({ part, name, number }) => (
        <Row key={name} part={part} name={name} levels={levelsOf(net, number)} />
      ))}
    </Section>
  );
}

function Row({
  part,
  name,
  levels: [low, high],
}: {
  part: string | null;
  name: string;
  levels: [number, number];
}) {
  const finer = low === high ? low + 1 : high;
  const coarser = low === high ? low - 1 : low;
  return (
    <div className="density-row">
      <span>{name}</span>
      <span className="density-levels">{low === high ? low : `${low} to ${high}`}</span>
      <Step part={part} name={name} level={coarser} word="Coarser" disabled={coarser < 0} />
      <Step part={part} name={name} level={finer} word="Finer" disabled={finer > DEEPEST} />
    </div>
  );
}

function Step({
  part,
  name,
  level,
  word,
  disabled,
}: {
  part: string | null;
  name: string;
  level: number;
  word: string;
  disabled: boolean;
}) {
  const action = { type: "set_density" as const, part, level };
  return (
    <Hint text={`${word}: ${name} to level ${level}`} side="left">
      <button
        type="button"
        className="icon-button small"
        aria-label={`${word}: ${name}`}
        disabled={disabled}
        {...foreseen(`${name} to level ${level}`, action)}
        onClick={() => {
          forget();
          ask(action, "Changing the density");
        }}
      >
        {word === "Finer" ? <Plus /> : <Minus />}
      </button>
    </Hint>
  );
}

/** Lowest and highest level of a part's cells; of all if its number is negative. */
function levelsOf(net: Net, part: number): [number, number] {
  let low = DEEPEST;
  let high = 0;
  net.cellLevel.forEach((level, cell) => {
    if (part >= 0 && net.cellPart[cell] !== part) return;
    low = Math.min(low, level);
    high = Math.max(high, level);
  });
  return low <= high ? [low, high] : [0, 0];
}
