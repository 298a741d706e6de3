// What is selected: cells, a spring, or a node with its coordinates, and what can be done with it.
import { groupOf } from "../document/net";
import { plainType } from "../document/quantities";
import { selectedRows } from "../document/selection";
import { ask } from "../document/store";
import { commandOf, retype } from "./commands";
import { useDialogs } from "./dialogs";
import { SpringCard } from "./HoverCard";
import { Choice, Fact, Hint, NumberField, Section } from "./parts";
import { useStage, useStudio } from "./use";

export function SelectionSections() {
  const selection = useStudio((state) => state.selection);
  const net = useStudio((state) => state.net);
  const there = useStudio((state) => state.motion?.header.revision === state.net?.revision);
  if (!net || !there || selection.keys.length === 0) return null;
  const rows = selectedRows(net, selection, selection.kind);
  if (!rows.length) return null;
  if (selection.kind === "cells") return <Cells rows={rows} />;
  if (selection.kind === "springs") return <Springs rows={rows} />;
  return rows.length === 1 ? <Node node={rows[0]} /> : null;
}

function Cells({ rows }: { rows: number[] }) {
  const net = useStudio((state) => state.net)!;
  const forces = useStudio((state) => state.motion!.forces);
  const types = useStudio((state) => state.document!.cell_types);
  const kinds = new Set(rows.map((row) => plainType(net.types[row])));
  const springs = new Set(rows.flatMap((row) => [...groupOf(net.own, row)]));
  const inner = rows.reduce(
    (sum, row) => groupOf(net.own, row).reduce((all, spring) => all + forces[spring], sum),
    0,
  );
  const kind = kinds.size === 1 ? [...kinds][0] : "";
  const options = types.map(({ word, name }) => ({
    value: word,
    name: word === name ? word : `${word} ${name}`,
  }));
  return (
    <Section title={rows.length === 1 ? `Cell ${net.addresses[rows[0]]}` : `${rows.length} cells`}>
      <Choice
        label="Type"
        value={kind}
        options={
          options.some(({ value }) => value === kind)
            ? options
            : [{ value: kind, name: kind || "mixed" }, ...options]
        }
        onTake={(value) => value && retype(value)}
      />
      <Fact
        name="Level"
        value={[...new Set(rows.map((row) => net.cellLevel[row]))].sort().join(", ")}
      />
      <Fact name="Springs" value={springs.size} digits={6} />
      <Fact
        name="Inner force"
        value={inner}
        unit="N"
        title="Sum of the forces of the springs of each cell"
      />
      <div className="row">
        <CommandWord id="subdivide" word="Subdivide" />
        <CommandWord id="off" word="Off" />
        <CommandWord id="on" word="On" />
        <CommandWord id="turn" word="Turn" />
      </div>
    </Section>
  );
}

function Springs({ rows }: { rows: number[] }) {
  const forces = useStudio((state) => state.motion!.forces);
  if (rows.length === 1) {
    return (
      <Section title="Spring">
        <div className="spring-facts">
          <SpringCard spring={rows[0]} />
        </div>
        <div className="row">
          <CommandWord id="cut" word="Cut" />
        </div>
      </Section>
    );
  }
  const chosen = rows.map((row) => forces[row]);
  return (
    <Section title={`${rows.length} springs`}>
      <Fact name="Largest force" value={Math.max(...chosen)} unit="N" />
      <Fact name="Smallest force" value={Math.min(...chosen)} unit="N" />
    </Section>
  );
}

function Node({ node }: { node: number }) {
  const net = useStudio((state) => state.net)!;
  const motion = useStudio((state) => state.motion)!;
  const anchors = useStudio((state) => state.document!.anchors);
  const anchor = anchors.find(({ node: key }) => key === net.nodes[node]);
  const at = [...motion.positions.subarray(3 * node, 3 * node + 3)];
  if (!anchor) {
    return (
      <Section title={`Node ${net.nodes[node]}`}>
        {["x", "y", "z"].map((axis, place) => (
          <Fact key={axis} name={axis} value={at[place]} unit="m" />
        ))}
        <div className="row">
          <CommandWord id="hold" word="Hold as an anchor" />
        </div>
      </Section>
    );
  }
  const number = net.anchorNames.indexOf(anchor.name);
  const reaction = motion.reactions.subarray(3 * number, 3 * number + 3);
  const move = (axis: number, value: number) => {
    const position = anchor.position.map((old, place) => (place === axis ? value : old));
    ask({ type: "move_anchor", anchor: anchor.name, position }, "Moving the anchor");
  };
  return (
    <Section title={`Anchor ${anchor.name}`}>
      {["x", "y", "z"].map((axis, place) => (
        <NumberField
          key={axis}
          label={axis}
          value={anchor.position[place]}
          unit="m"
          onTake={(value) => move(place, value)}
        />
      ))}
      <Fact name="Reaction" value={Math.hypot(...reaction)} unit="N" />
      <Fact
        name="along x, y, z"
        value={[...reaction].map((part) => part.toFixed(3).replace("-", "−")).join("  ")}
        unit="N"
      />
      <div className="row">
        <CommandWord id="let-go" word="Let go" />
      </div>
    </Section>
  );
}

function CommandWord({ id, word }: { id: string; word: string }) {
  const command = commandOf(id);
  const refused = useStudio((state) => command.refused?.(state) ?? null);
  const viewport = useStage()?.viewport ?? null;
  const dialogs = useDialogs();
  return (
    <Hint text={command.label} keys={command.keys}>
      <button
        type="button"
        className="button"
        aria-disabled={refused !== null}
        onClick={() => refused === null && command.run({ viewport, dialogs })}
      >
        {word}
      </button>
    </Hint>
  );
}
