// Graft: a ghost of the patch follows the pointer over cells and anchors; a click keeps it there.
import { grafting } from "../document/grafting";
import { plan, topLevel } from "../document/planning";
import { store } from "../document/store";
import type { Hit } from "../viewport/picking";
import type { Viewport } from "../viewport/scene";
import type { Tool } from "./tool";

export class Grafting implements Tool {
  readonly reach = { nodes: true, cells: true };
  readonly cursor = "copy";

  down(): boolean {
    return false;
  }

  drag(): void {}
  drop(): void {}

  click(_: Viewport, hit: Hit | null): void {
    const target = targetOf(hit);
    if (grafting.getState().place === "anchors" || !grafting.getState().chosen) return;
    grafting.setState(target ? { target, pinned: true } : { pinned: false });
    plan();
  }

  hover(_: Viewport, hit: Hit | null): void {
    const { chosen, place, pinned, target } = grafting.getState();
    if (!chosen || place === "anchors" || pinned) return;
    const next = targetOf(hit);
    if (next?.cell === target?.cell && next?.anchor === target?.anchor) return;
    grafting.setState({ target: next });
    plan();
  }

  cancel(): void {
    grafting.setState({ target: null, pinned: false, plan: null, problem: "" });
  }
}

function targetOf(hit: Hit | null): { cell: number | null; anchor: string | null } | null {
  const { net } = store.getState();
  const { chosen, patches } = grafting.getState();
  if (!net || !hit) return null;
  if (hit.kind === "cell") return { cell: topLevel(net.addresses[hit.row]), anchor: null };
  const anchored = patches?.patches.find(({ name }) => name === chosen)?.anchored;
  const anchor = [...net.anchors].indexOf(hit.row);
  return anchored && anchor >= 0 ? { cell: null, anchor: net.anchorNames[anchor] } : null;
}
