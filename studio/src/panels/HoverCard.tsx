// What the pointer is on: a spring with its force, length, rest length and formula; a node; a cell.
import { typeName } from "../document/cellTypes";
import { isEvolving } from "../document/editable";
import { formulaOf, lawOf, SENSES } from "../document/laws";
import { groupOf, springCells } from "../document/net";
import { lengthsOf, stressOf } from "../document/quantities";
import { inDigits, inFull } from "../document/scale";
import type { Hover, State, ToolId } from "../document/store";
import { useStudio } from "./use";

const KEPT_FREE = [360, 280]; // px, where the pointer would be under the card

export function HoverCard() {
  const hover = useStudio((state) => state.hover);
  const net = useStudio((state) => state.net);
  const motion = useStudio((state) => (state.hover ? state.motion : null));
  // The ghost of a graft is what matters then, and the card would hide it.
  const tool = useStudio((state) => state.tool);
  if (tool === "graft" || !hover || !net || !motion || motion.header.revision !== net.revision)
    return null;
  // In a corner, so that nothing of what is worked on is hidden.
  const [wide, high] = hover.room;
  const under = hover.x > wide - KEPT_FREE[0] && hover.y > high - KEPT_FREE[1];
  const classes = ["hover-card", under && "above", tool !== "pull" && "small"];
  if (tool !== "pull")
    return (
      <div className={classes.filter(Boolean).join(" ")} role="status">
        <WouldDo hover={hover} tool={tool} />
      </div>
    );
  return (
    <div className={classes.filter(Boolean).join(" ")} role="status">
      {hover.kind === "spring" && <SpringCard spring={hover.row} />}
      {hover.kind === "node" && <NodeCard node={hover.row} />}
      {hover.kind === "cell" && <CellCard cell={hover.row} />}
    </div>
  );
}

/** What the tool in the hand would do here. */
function WouldDo({ hover, tool }: { hover: Hover; tool: ToolId }) {
  const net = useStudio((state) => state.net)!;
  const does = useStudio((state) => deedOf(tool, state));
  const anchor = hover.kind === "node" ? net.anchors.indexOf(hover.row) : -1;
  const name =
    hover.kind === "cell"
      ? `Cell ${net.addresses[hover.row]}, type ${typeName(net.types[hover.row])}`
      : hover.kind === "spring"
        ? "Spring"
        : anchor >= 0
          ? `Anchor ${net.anchorNames[anchor]}`
          : "Node";
  return (
    <>
      <b>{name}</b>
      <span>{does}</span>
    </>
  );
}

function deedOf(tool: ToolId, { brush, brushType }: State): string {
  const weighing =
    brush === null ? "brush: erase" : brush < 1 ? "brush: keep out" : "brush: grow here";
  const deeds: Partial<Record<ToolId, string>> = {
    subdivide: "brush: subdivide",
    retype: `brush: give type ${typeName(brushType)}`,
    weigh: weighing,
    cut: "click: cut it",
    add: "click: tie a spring here",
    ring: "click: select the cells round it",
    row: "click: select its row",
    loop: "click: select its loop",
    part: "click: select its cylinder",
    band: "click: select all of its force",
  };
  return deeds[tool] ?? "";
}

/** Everything that is known of a spring. */
export function SpringCard({ spring }: { spring: number }) {
  const net = useStudio((state) => state.net)!;
  const motion = useStudio((state) => state.motion)!;
  const force = motion.forces[spring];
  const length = lengthsOf(net, motion)[spring];
  const rest = net.restLength[spring];
  const law = lawOf(net, spring);
  const ends = [net.nodes[net.ends[2 * spring]], net.nodes[net.ends[2 * spring + 1]]];
  const cells = [...groupOf(springCells(net), spring)].map((cell) => net.addresses[cell]);
  return (
    <>
      <header>
        <b>{law.key === "rod" ? "Rod" : "Spring"}</b>
        <span>
          {ends[0]} – {ends[1]}
        </span>
      </header>
      <Line name="Force" symbol="F" value={force} unit="N" strong />
      <Line name="Length" symbol="L" value={length} unit="m" />
      {law.elastic && <Line name="Unstressed length" symbol="L0" value={rest} unit="m" />}
      <Line
        name={law.constant.name}
        symbol={law.constant.symbol}
        value={law.value(net, spring)}
        unit={law.constant.unit}
      />
      {rest > 0 && <Line name="Strain" symbol="ε" value={(length - rest) / rest} unit="" />}
      {net.area[spring] > 0 && (
        <Line name="Stress" symbol="σ" value={stressOf(force, net.area[spring])} unit="N/mm²" />
      )}
      <Line name="Force density" symbol="q" value={force / length} unit="N/m" />
      <footer>
        <code>{formulaOf(net, spring)}</code>
        <span>{SENSES[net.sense[spring]].name}</span>
      </footer>
      <footer>
        <span>{law.constant.symbol === "EA" ? "EA of the unstressed length L0" : ""}</span>
        <span>{cells.length ? `cell ${cells.slice(0, 2).join(", ")}` : "no cell"}</span>
      </footer>
    </>
  );
}

/** Why a node can't be dragged now. */
function whyStays(state: State, anchor: boolean): string {
  if (isEvolving(state)) return anchor ? "" : "the net evolves";
  return anchor && state.document?.looking ? "this is not your design" : "";
}

function NodeCard({ node }: { node: number }) {
  const net = useStudio((state) => state.net)!;
  const motion = useStudio((state) => state.motion)!;
  const anchor = net.anchors.indexOf(node);
  const held = useStudio((state) => whyStays(state, anchor >= 0));
  const at = 3 * node;
  const reaction = anchor >= 0 ? motion.reactions.subarray(3 * anchor, 3 * anchor + 3) : null;
  return (
    <>
      <header>
        <b>{anchor >= 0 ? `Anchor ${net.anchorNames[anchor]}` : "Node"}</b>
        <span>{net.nodes[node]}</span>
      </header>
      {["x", "y", "z"].map((axis, place) => (
        <Line key={axis} name={axis} symbol="" value={motion.positions[at + place]} unit="m" />
      ))}
      {reaction && (
        <Line name="Reaction" symbol="R" value={Math.hypot(...reaction)} unit="N" strong />
      )}
      <footer>
        {held ? (
          <span>stays where it is: {held}</span>
        ) : (
          <>
            <span>{anchor >= 0 ? "drag to move it" : "drag to pull the net"}</span>
            <span>⇧ vertical · Ctrl level</span>
          </>
        )}
      </footer>
    </>
  );
}

function CellCard({ cell }: { cell: number }) {
  const net = useStudio((state) => state.net)!;
  const motion = useStudio((state) => state.motion)!;
  const springs = [...groupOf(net.own, cell)];
  const inner = springs.reduce((sum, spring) => sum + motion.forces[spring], 0);
  return (
    <>
      <header>
        <b>Cell {net.addresses[cell]}</b>
        <span>{net.parts[net.cellPart[cell]]}</span>
      </header>
      <Line name="Type" symbol="" value={typeName(net.types[cell])} unit="" />
      <Line name="Level" symbol="" value={net.cellLevel[cell]} unit="" />
      <Line name="Springs" symbol="" value={inFull(springs.length)} unit="" />
      <Line name="Inner force" symbol="ΣF" value={inner} unit="N" strong />
    </>
  );
}

function Line({
  name,
  symbol,
  value,
  unit,
  strong,
}: {
  name: string;
  symbol: string;
  value: number | string;
  unit: string;
  strong?: boolean;
}) {
  return (
    <div className={strong ? "line strong" : "line"}>
      <span>
        {name}
        {symbol && <i>{symbol}</i>}
      </span>
      <span>
        {typeof value === "string" ? value : inDigits(value, 4)}{" "}
        <span className="unit">{unit}</span>
      </span>
    </div>
  );
}
