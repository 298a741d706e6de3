// Put into a page before its own scripts: notes when the pointer moves, when the page asks the engine, and when
// what it asked for is there, applied and drawn. All times in ms by the page's clock.

/** How a move of the pointer became new positions [ms]. */
export interface Move {
  /** From the pointer's event until the page asks: its queue, and the page's own work. */
  asked: number;
  /** In the engine, until a step begins, and the step. */
  waited: number;
  solved: number;
  /** On the way there and back, and in the queues of the engine and of the page. */
  carried: number;
  /** In the page, until the positions are decoded and in its store. */
  applied: number;
  /** After that, until the page has drawn them. */
  drawn: number;
}

/** What is measured from `begin` on. */
export interface Figures {
  springs: number;
  /** From the pointer's event until new positions are in the page [ms]; of every move. */
  delays: number[];
  /** Moves that were answered each by a frame of their own. */
  moves: Move[];
  /** Frames of motion a second that were taken, and pictures a second that were drawn. */
  taken: number;
  drawn: number;
  /** Bytes of the last frame of motion. */
  size: number;
  /** From the frame in which a move of the pointer is seen until what lies under it is known and told [ms]. */
  hovers: number[];
}

/** Runs in the page, so it uses nothing from outside. */
export function watch(): void {
  interface Asked {
    event: number;
    sent: number;
    place: number[];
  }
  const page = globalThis as never as { figures: Figures; begin(): void };
  let springs = 0;
  let open: Asked[] = [];
  let event = 0;
  let inside = false;
  let began = 0;
  let frames = 0;
  let pictures = 0;
  page.begin = () => {
    open = [];
    frames = pictures = 0;
    began = performance.now();
    page.figures = {
      springs,
      delays: [],
      moves: [],
      hovers: [],
      size: 0,
      get taken() {
        return (1000 * frames) / (performance.now() - began);
      },
      get drawn() {
        return (1000 * pictures) / (performance.now() - began);
      },
    };
  };
  page.begin();

  addEventListener(
    "pointermove",
    ({ timeStamp }) => {
      event = timeStamp;
      inside = true;
    },
    true,
  );
  addEventListener("pointermove", () => {
    inside = false;
  });
  addEventListener(
    "pointerrawupdate",
    ({ timeStamp }) => {
      event = timeStamp;
    },
    true,
  );
  const nextFrame = requestAnimationFrame.bind(globalThis);
  globalThis.requestAnimationFrame = (callback) => {
    if (!inside) return nextFrame(callback);
    return nextFrame((time) => {
      const start = performance.now();
      callback(time);
      page.figures.hovers.push(performance.now() - start);
    });
  };
  const count = () => {
    pictures++;
    nextFrame(count);
  };
  nextFrame(count);

  const { send } = WebSocket.prototype;
  WebSocket.prototype.send = function (this: WebSocket, data) {
    const request = typeof data === "string" ? JSON.parse(data) : {};
    if (request.type === "hold")
      open.push({ event, sent: performance.now(), place: request.position });
    send.call(this, data);
  };

  const taken = (received: number, data: ArrayBuffer, handle: () => void) => {
    const length = new DataView(data).getUint32(0, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
    const positions = header.arrays.find(({ name }: { name: string }) => name === "positions");
    const forces = header.arrays.find(({ name }: { name: string }) => name === "forces");
    if (header.frame !== "motion") return handle();
    springs = page.figures.springs = forces.length;
    page.figures.size = data.byteLength;
    frames++;
    const places = new Float32Array(data, 4 + length, positions.length);
    const held = header.held.length ? 3 * header.held[0] : -1;
    const near = ({ place }: Asked) =>
      place.every(
        (value, axis) => Math.abs(places[held + axis] - value) < 1e-5 * (1 + Math.abs(value)),
      );
    const answered = held < 0 ? -1 : open.findLastIndex(near);
    const start = performance.now();
    handle();
    const end = performance.now();
    if (answered < 0) return;
    const done = open.splice(0, answered + 1);
    for (const { event: from } of done) page.figures.delays.push(end - (start - received) - from);
    const { event: from, sent } = done[done.length - 1];
    const [waited, solved] = [1000 * header.waited, 1000 * header.took];
    nextFrame(() => {
      const carried = received - sent - waited - solved;
      const drawn = performance.now() - end;
      page.figures.moves.push({
        asked: sent - from,
        waited,
        solved,
        carried,
        applied: end - start,
        drawn,
      });
    });
  };
  const handler = Object.getOwnPropertyDescriptor(WebSocket.prototype, "onmessage")!;
  Object.defineProperty(WebSocket.prototype, "onmessage", {
    ...handler,
    set(this: WebSocket, handle: (message: MessageEvent) => void) {
      handler.set!.call(this, (message: MessageEvent) => {
        const received = performance.now();
        if (typeof message.data === "string") handle.call(this, message);
        else taken(received, message.data, () => handle.call(this, message));
      });
    },
  });
}
