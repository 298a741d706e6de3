// The tools at the left edge.
import { Brush, Hand, PaintBucket, Scissors, Sprout, Waypoints } from "lucide-react";
import type { ReactNode } from "react";
import { store, type ToolId } from "../document/store";
import { commandOf } from "./commands";
import { Choice, IconButton } from "./parts";
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
];

export function ToolRail() {
  const tool = useStudio((state) => state.tool);
  return (
    <nav className="tool-rail" aria-label="Tools">
      {TOOLS.map(({ id, icon }) => {
        const { label, keys } = commandOf(`tool-${id}`);
        return (
          <IconButton
            key={id}
            label={label}
            keys={keys}
            side="right"
            pressed={tool === id}
            onClick={() => store.setState({ tool: id })}
          >
            {icon}
          </IconButton>
        );
      })}
    </nav>
  );
}

/** What the tool in the hand does, in a line over the net. */
export function ToolHelp() {
  const tool = useStudio((state) => state.tool);
  return (
    <div className="tool-help">
      <span>{TOOLS.find(({ id }) => id === tool)!.help}</span>
      {tool === "retype" && <BrushType />}
    </div>
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
      options={types.map(({ word, name }) => ({
        value: word,
        name: word === name ? word : `${word} ${name}`,
      }))}
      onTake={(brushType) => store.setState({ brushType })}
    />
  );
}
