// What an action would do, told by the engine before it is done and drawn as a ghost over the net.
import type { Protocol } from "../protocol/messages";
import { askQuietly, store } from "./store";

type Preview = Extract<Protocol["request"], { type: "preview" }>;
type Numbered = Preview["action"];
type WithoutNumber<R> = R extends unknown ? Omit<R, "id"> : never;

/** An action that can be looked at before it is done. */
export type Foreseen = WithoutNumber<Numbered>;

const WAIT = 200; // ms
let number = 0;

/** Shows what an action would do, after a moment. */
export function foresee(label: string, action: Foreseen, wait = WAIT): void {
  const own = ++number;
  setTimeout(async () => {
    if (own !== number) return;
    try {
      const reply = await askQuietly(
        { type: "preview", action: { ...action, id: 0 } as Numbered },
        "Working out what it would do",
      );
      if (own === number && reply.preview)
        store.setState({ preview: { label, state: reply.preview, problem: "" } });
    } catch (error) {
      if (own === number)
        store.setState({ preview: { label, state: null, problem: (error as Error).message } });
    }
  }, wait);
}

// Once something is done, what it would have done is the past.
store.subscribe(({ document: now }, { document: before }) => {
  if (now?.document !== before?.document || now?.position !== before?.position) forget();
});

/** Shows no preview any more. */
export function forget(): void {
  number++;
  if (store.getState().preview) store.setState({ preview: null });
}
