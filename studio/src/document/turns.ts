// One thing after the other: what depends on the document waits for answers on their way, and finds it as they leave it.
import { type State, store } from "./store";

const waiting: (() => void)[] = [];
let asked = 0;

/**
 * Does something with the document as it is once all that was asked before is answered and shown: at once if nothing
 * is on its way. It is not done any more once another document is opened.
 */
export function inTurn(act: () => void): void {
  if (waiting.length === 0 && isSettled(store.getState())) act();
  else waiting.push(act);
}

/** Whether the document here is the engine's, as far as is known. */
function isSettled({ awaited, line, document, net }: State): boolean {
  if (awaited > 0) return false;
  // Without a line nothing more comes, and whoever asks is told so.
  return line !== "open" || !document || (net !== null && net.revision >= document.revision);
}

store.subscribe((state, before) => {
  if (state.document?.document !== before.document?.document) waiting.length = 0;
  // A little later, since whoever awaited the answer goes on first.
  if (waiting.length && !asked && isSettled(state)) asked = window.setTimeout(next);
});

function next(): void {
  asked = 0;
  while (waiting.length && isSettled(store.getState())) waiting.shift()!();
}
