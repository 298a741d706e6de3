// The tools at the left edge.
import {
  Brush,
  CircleDashed,
  Cylinder,
  Gauge,
  Hand,
  LassoSelect,
  MoveVertical,
  PaintBucket,
  Rows3,
  Scissors,
  Sprout,
  SquareDashed,
  Waypoints,
} from "lucide-react";
import type { ReactNode } from "react";
import { springsOfType, typeName } from "../document/cellTypes";
import { isEvolving, notEditable } from "../document/editable";
import { store, type ToolId } from "../document/store";
import { EDITING } from "../tools/hands";
import { commandOf } from "./commands";
import { Choice, IconButton, Keys } from "./parts";
import { useStudio } from "./use";

const TOOLS: { id: ToolId; icon: ReactNode; help: string }[] = [
  {
    id: "pull",
    icon: <Hand />,
    help: "Click to select. Drag a node to pull the net, an anchor to move it; Shift: up and down, Ctrl: level.",
  },
  { id: "subdivide", icon: <Brush />, help: "Brush over cells to subdivide them." },
  { id: "retype", icon: <PaintBucket />, help: "Brush over cells to give them the type" },
  { id: "cut", icon: <Scissors />, help: "Click a spring to cut it." },
  {
    id: "add",
    icon: <Waypoints />,
    help: "Click one node, then another, to tie a spring between them.",
  },
  {
    id: "weigh",
    icon: <Sprout />,
    help: "Brush over cells where evolution is to grow, or to keep out: choose which in the Evolve panel.",
  },
  {
    id: "box",
    icon: <SquareDashed />,
    help: "Drag a box over cells to select them; Shift adds, Ctrl takes those behind too.",
  },
  {
    id: "lasso",
    icon: <LassoSelect />,
    help: "Draw round cells to select them; Shift adds, Ctrl takes those behind too.",
  },
  {
    id: "ring",
    icon: <CircleDashed />,
    help: "Click an anchor or a node to select the cells round it; each further click adds a ring.",
  },
  {
    id: "row",
    icon: <Rows3 />,
    help: "Click a cell to select all of its cylinder at its height; Shift adds.",
  },
  {
    id: "loop",
    icon: <MoveVertical />,
    help: "Click a cell to select those before and behind it, from edge to edge; Shift adds.",
  },
  {
    id: "part",
    icon: <Cylinder />,
    help: "Click a cell to select its whole cylinder; Shift adds.",
  },
  {
    id: "band",
    icon: <Gauge />,
    help: "Click a cell to select all that carry the same force, to a tenth; Shift adds.",
  },
];

const HELP: Record<string, string> = {
  graft:
    "The ghost follows the pointer over cells and anchors; a click keeps it. R rotates, M mirrors, Enter applies.",
  evolving:
    "Click to select. Drag an anchor to move it while the net evolves; Shift: up and down, Ctrl: level.",
  looking:
    "Click to select. Drag a node to pull the net, which returns; anchors can be moved once you take it over.",
};

export function ToolRail() {
  const tool = useStudio((state) => state.tool);
  const problem = useStudio(notEditable);
  return (
    <nav className="tool-rail" aria-label="Tools">
      {TOOLS.map(({ id, icon }) => {
        const { label, keys } = commandOf(`tool-${id}`);
        const refused = EDITING.has(id) ? problem : null;
        return (
          <IconButton
            key={id}
            label={label}
            {...(refused ? { text: `${label}: not now, ${refused}`, "aria-disabled": true } : {})}
            keys={keys}
            side="right"
            pressed={tool === id}
            onClick={() => refused === null && store.setState({ tool: id })}
          >
            {icon}
          </IconButton>
        );
      })}
    </nav>
  );
}

function helpOf(tool: ToolId, problem: string | null, evolves: boolean): string {
  if (problem && EDITING.has(tool)) return `Not now: ${problem}.`;
  if (problem && tool === "pull") return evolves ? HELP.evolving : HELP.looking;
  return HELP[tool] ?? TOOLS.find(({ id }) => id === tool)!.help;
}

/** What the tool in the hand does, in a line over the net. */
export function ToolHelp() {
  const tool = useStudio((state) => state.tool);
  const problem = useStudio(notEditable);
  const evolves = useStudio(isEvolving);
  const brushes = tool === "subdivide" || tool === "retype" || tool === "weigh";
  return (
    <div className="tool-help">
      <span>{helpOf(tool, problem, evolves)}</span>
      {brushes && (
        <span className="brush-keys">
          Size <Keys keys="[" /> <Keys keys="]" />
        </span>
      )}
      {tool === "retype" && <BrushType />}
    </div>
  );
}

/** The brush over the net, as large as it is. */
export function BrushCircle() {
  const at = useStudio((state) => state.brushAt);
  const radius = useStudio((state) => state.brushRadius);
  if (!at) return null;
  const size = 2 * radius;
  const transform = `translate(${at[0] - radius}px, ${at[1] - radius}px)`;
  return (
    <i
      className="brush-circle"
      aria-hidden="true"
      style={{ width: size, height: size, transform }}
    />
  );
}

function BrushType() {
  const types = useStudio((state) => state.document?.cell_types ?? []);
  const wanted = useStudio((state) => state.brushType);
  return (
    <Choice
      label="Type of the brush"
      hidden
      value={wanted}
      options={types.map(({ word }) => ({
        value: word,
        name: typeName(word),
        explains: springsOfType(word),
      }))}
      onTake={(brushType) => store.setState({ brushType })}
    />
  );
}
