// Whether the net that is shown can be edited now, in the words of the engine, which refuses the same.
import type { State } from "./store";

/** Why edits would be refused; null: they would not. */
export function notEditable({ live, document }: Pick<State, "live" | "document">): string | null {
  if (isEvolving({ live })) return "the net evolves; keep or discard what it grew first";
  return document?.looking
    ? "this is not your design; take it over, or go back to your design"
    : null;
}

/** Whether the net evolves live, or stands while it does. */
export function isEvolving({ live }: Pick<State, "live">): boolean {
  return live !== null && live.status !== "none";
}
