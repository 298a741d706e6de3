// A node: where it is, how it is held, and what holds it.
import { useState } from "react";
import { ask } from "../document/store";
import type { DocumentState } from "../protocol/messages";
import { Choice, Fact, NumberField, Section } from "./parts";
import { useStudio } from "./use";

type Anchor = DocumentState["anchors"][number];

const AXES = ["x", "y", "z"] as const;

/** Ways to hold a node, by a word of their own. */
const WAYS = [
  { value: "free", name: "free", explains: "nothing holds it" },
  { value: "xyz", name: "fixed", explains: "held where it is: an anchor" },
  { value: "xy", name: "slides along z", explains: "held in x and y" },
  { value: "xz", name: "slides along y", explains: "held in x and z" },
  { value: "yz", name: "slides along x", explains: "held in y and z" },
  { value: "z", name: "slides level, in x and y", explains: "held at its height" },
  { value: "y", name: "slides in x and z", explains: "held in y" },
  { value: "x", name: "slides in y and z", explains: "held in x" },
  { value: "line", name: "slides on a line", explains: "free along one direction of its own" },
  { value: "plane", name: "slides in a plane", explains: "free across one direction of its own" },
] as const;
type Way = (typeof WAYS)[number]["value"];

/** Holds a node in a way, or lets it go. */
export function support(node: string, way: Way, direction = [0, 0, 1]): void {
  const sliding = way === "line" || way === "plane";
  ask(
    {
      type: "fix_node",
      node,
      fixed: way !== "free",
      holds: way === "free" || sliding ? "xyz" : way,
      line: way === "line" ? direction : null,
      plane: way === "plane" ? direction : null,
    },
    "Changing the support",
  );
}

export function NodeSection({ node }: { node: number }) {
  const net = useStudio((state) => state.net)!;
  const motion = useStudio((state) => state.motion)!;
  const anchors = useStudio((state) => state.document!.anchors);
  const key = net.nodes[node];
  const anchor = anchors.find((one) => one.node === key) ?? null;
  const at = [...motion.positions.subarray(3 * node, 3 * node + 3)];
  const corner = key.startsWith("v");
  return (
    <Section title={anchor ? `Anchor ${anchor.name}` : `Node ${key}`}>
      {anchor
        ? AXES.map((axis, place) => (
            <NumberField
              key={axis}
              label={axis}
              value={anchor.position[place]}
              unit="m"
              onTake={(value) => move(anchor, place, value)}
            />
          ))
        : AXES.map((axis, place) => <Fact key={axis} name={axis} value={at[place]} unit="m" />)}
      {anchor && wayOf(anchor) !== "xyz" && (
        <Fact name="is now at" value={at.map((value) => tidy(value)).join("  ")} unit="m" />
      )}
      {corner ? (
        <Support key={`${key} ${JSON.stringify(anchor)}`} node={key} anchor={anchor} />
      ) : (
        <p className="explain">
          This node lies inside a cell or on an edge; only corners of top-level cells can be held.
        </p>
      )}
      {anchor && <Reaction name={anchor.name} />}
    </Section>
  );
}

function Support({ node, anchor }: { node: string; anchor: Anchor | null }) {
  const now = anchor ? wayOf(anchor) : "free";
  const [way, setWay] = useState<Way>(now);
  const [direction, setDirection] = useState(anchor?.line ?? anchor?.plane ?? [0, 0, 1]);
  const turned = way === "line" || way === "plane";
  return (
    <>
      <Choice
        label="Support"
        value={way}
        options={[...WAYS]}
        onTake={(value) => {
          setWay(value);
          if (value !== "line" && value !== "plane") support(node, value);
        }}
      />
      {turned && (
        <fieldset className="direction">
          <legend>{way === "line" ? "Direction of the line" : "Normal of the plane"}</legend>
          {AXES.map((axis, place) => (
            <NumberField
              key={axis}
              label={axis}
              value={direction[place]}
              onTake={(value) =>
                setDirection(direction.map((old, one) => (one === place ? value : old)))
              }
            />
          ))}
          <button type="button" className="button" onClick={() => support(node, way, direction)}>
            Apply
          </button>
        </fieldset>
      )}
    </>
  );
}

function Reaction({ name }: { name: string }) {
  const number = useStudio((state) => state.net!.anchorNames.indexOf(name));
  const reactions = useStudio((state) => state.motion!.reactions);
  const reaction = [...reactions.subarray(3 * number, 3 * number + 3)];
  return (
    <>
      <Fact
        name="Reaction R"
        value={Math.hypot(...reaction)}
        unit="N"
        title="What holds the anchor"
      />
      <Fact name="along x, y, z" value={reaction.map(tidy).join("  ")} unit="N" />
    </>
  );
}

function move(anchor: Anchor, axis: number, value: number): Promise<unknown> {
  const position = anchor.position.map((old, place) => (place === axis ? value : old));
  return ask({ type: "move_anchor", anchor: anchor.name, position }, "Moving the anchor");
}

function wayOf({ holds, line, plane }: Anchor): Way {
  return line ? "line" : plane ? "plane" : (holds as Way);
}

function tidy(value: number): string {
  return value.toFixed(3).replace("-", "−");
}
