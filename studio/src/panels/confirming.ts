// What is told once it is done, with the way back: nets that are taken over, kept or discarded.
import { toast } from "sonner";
import { shownSide } from "../document/pins";
import { inFull } from "../document/scale";
import { ask, notify, store } from "../document/store";

/** Makes what is looked at the design. */
export async function takeOver(): Promise<void> {
  const { document } = store.getState();
  // The button is still there for a moment when it is pressed twice; so it is below.
  if (!document?.looking) return;
  const { label } = document.looking;
  const reply = await ask({ type: "reinstate", side: shownSide(document) }, "Taking it over");
  if (reply) confirmAction(`Your design is now: ${label}`);
}

/** Makes the net that evolves live the design. */
export async function keepGrown(): Promise<void> {
  if (!isGrown()) return;
  const { live, document } = store.getState();
  const generation = live?.generation ?? 0;
  const reply = await ask({ type: "live_evolve", what: "keep", parameters: {} }, "Keeping the net");
  if (!reply) return;
  if (store.getState().document?.position === document?.position)
    toast.message("Nothing better grew; your design is as it was", { id: "done" });
  else confirmAction(`Your design is now what grew in ${inFull(generation)} generations`);
}

/** Goes back to the design; what evolved live can be brought back. */
export async function discardGrown(): Promise<void> {
  if (!isGrown()) return;
  const reply = await ask({ type: "live_evolve", what: "discard", parameters: {} }, "Discarding");
  if (!reply) return;
  toast.message("What grew is discarded; your design is as it was", {
    id: "done",
    duration: 12_000,
    action: { label: "Undo this", onClick: restoreGrown },
  });
}

function isGrown(): boolean {
  return (store.getState().live?.status ?? "none") !== "none";
}

/** Brings back what was discarded last. */
export function restoreGrown(): void {
  ask({ type: "live_evolve", what: "restore", parameters: {} }, "Bringing it back");
}

/** Takes all marks of the brush away; they are no part of the design, so undo does not bring them back. */
export async function clearMarks(): Promise<void> {
  const marks = Object.entries(store.getState().live?.weights ?? {});
  const cleared = await ask({ type: "weigh_cells", cells: [], factor: null }, "Clearing marks");
  if (!cleared) return;
  const bringBack = () => {
    for (const factor of new Set(marks.map(([, one]) => one))) {
      const cells = marks.filter(([, one]) => one === factor).map(([cell]) => cell);
      ask({ type: "weigh_cells", cells, factor }, "Bringing the marks back");
    }
  };
  toast.message("The marks are cleared", {
    id: "done",
    duration: 12_000,
    action: { label: "Undo this", onClick: bringBack },
  });
}

/** Tells that the design was replaced, with an Undo of just that. */
function confirmAction(text: string): void {
  const { document } = store.getState();
  const done = document?.position ?? 0;
  toast.success(text, {
    id: "done",
    duration: 12_000,
    action: {
      label: "Undo this",
      onClick: () => {
        if (store.getState().document?.position === done)
          ask({ type: "undo", redo: false }, "Undoing");
        else notify("something else was done since; go back in the history");
      },
    },
  });
}
