// What holds the net: every anchor with its reaction, and their sum, which is what the loads weigh.

import { inDigits } from "../document/scale";
import { select } from "../document/store";
import { Section } from "./parts";
import { useCalmMotion, useStudio } from "./use";

export function ReactionTable() {
  const motion = useCalmMotion();
  const net = useStudio((state) => state.net);
  const anchors = useStudio((state) => state.document!.anchors);
  if (!net || !motion || motion.header.revision !== net.revision) return null;
  const rows = anchors.map(({ name, node }) => {
    const number = net.anchorNames.indexOf(name);
    return { name, node, force: [...motion.reactions.subarray(3 * number, 3 * number + 3)] };
  });
  const sum = [0, 1, 2].map((axis) => rows.reduce((all, { force }) => all + force[axis], 0));
  const largest = Math.max(...rows.map(({ force }) => Math.hypot(...force)), 1e-30);
  return (
    <Section title="Reactions" aside={<span className="aside">N, what holds the anchors</span>}>
      <table className="reactions">
        <thead>
          <tr>
            <th scope="col">Anchor</th>
            <th scope="col">x</th>
            <th scope="col">y</th>
            <th scope="col">z</th>
            <th scope="col">R</th>
          </tr>
        </thead>
        <tbody>
          {rows.map(({ name, node, force }) => (
            <tr key={name}>
              <th scope="row">
                <button type="button" onClick={() => select({ kind: "nodes", keys: [node] })}>
                  {name}
                </button>
              </th>
              {[...force, Math.hypot(...force)].map((value, column) => (
                // biome-ignore lint/suspicious/noArrayIndexKey: columns have no other name
                <td key={column}>{short(value, largest)}</td>
              ))}
            </tr>
          ))}
        </tbody>
        <tfoot>
          <tr>
            <th scope="row">Sum</th>
            {[...sum, Math.hypot(...sum)].map((value, column) => (
              // biome-ignore lint/suspicious/noArrayIndexKey: columns have no other name
              <td key={column}>{short(value, largest)}</td>
            ))}
          </tr>
        </tfoot>
      </table>
    </Section>
  );
}

/** A force beside the largest one: what single precision leaves over is shown as none. */
function short(value: number, largest: number): string {
  return Math.abs(value) < 1e-5 * largest ? "0" : inDigits(value, 3);
}
