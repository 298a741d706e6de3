// What is selected: cells, a spring, or a node with its coordinates, and what can be done with it.
import { grafting } from "../document/grafting";
import { groupOf } from "../document/net";
import { plainType } from "../document/quantities";
import { inFull } from "../document/scale";
import { selectedRows } from "../document/selection";
import { commandOf } from "./commands";
import { useDialogs } from "./dialogs";
import { foreseen } from "./foreseen";
import { SpringCard } from "./HoverCard";
import { NodeSection } from "./NodeSection";
import { Fact, Hint, Section } from "./parts";
import { perform } from "./performing";
import { TypePicker } from "./TypePicker";
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
  return rows.length === 1 ? <NodeSection node={rows[0]} /> : null;
}

function Cells({ rows }: { rows: number[] }) {
  const net = useStudio((state) => state.net)!;
  const forces = useStudio((state) => state.motion!.forces);
  const types = useStudio((state) => state.document!.cell_types);
  const kinds = new Set(rows.map((row) => plainType(net.types[row])));
  const springs = new Set<number>();
  let inner = 0;
  for (const row of rows)
    for (const spring of groupOf(net.own, row)) {
      springs.add(spring);
      inner += forces[spring];
    }
  const kind = kinds.size === 1 ? [...kinds][0] : "";
  return (
    <Section
      title={rows.length === 1 ? `Cell ${net.addresses[rows[0]]}` : `${inFull(rows.length)} cells`}
    >
      <TypePicker cells={rows.map((row) => net.addresses[row])} kind={kind} types={types} />
      <Fact
        name="Level"
        value={[...new Set(rows.map((row) => net.cellLevel[row]))].sort().join(", ")}
      />
      <Fact name="Springs" value={springs.size} count />
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
          <CommandWord id="same-force" word="Same force" />
        </div>
      </Section>
    );
  }
  const chosen = rows.map((row) => forces[row]);
  return (
    <Section title={`${inFull(rows.length)} springs`}>
      <Fact name="Largest force" value={Math.max(...chosen)} unit="N" />
      <Fact name="Smallest force" value={Math.min(...chosen)} unit="N" />
    </Section>
  );
}

function CommandWord({ id, word }: { id: string; word: string }) {
  const command = commandOf(id);
  const selection = useStudio((state) => state.selection);
  const cells = selection.kind === "cells" ? selection.keys : [];
  const what = id === "subdivide" || id === "off" || id === "on" || id === "turn" ? id : null;
  const refused = useStudio((state) => command.refused?.(state) ?? null);
  const viewport = useStage()?.viewport ?? null;
  const dialogs = useDialogs();
  return (
    <Hint text={command.label} keys={command.keys}>
      <button
        type="button"
        className="button"
        aria-disabled={refused !== null}
        {...(what
          ? foreseen(command.label, {
              type: "edit_cells",
              what,
              cells,
              kind: null,
              orbit: grafting.getState().lock,
            })
          : {})}
        onClick={() => perform(command, { viewport, dialogs })}
      >
        {word}
      </button>
    </Hint>
  );
}
