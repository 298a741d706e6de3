// The line to the engine: requests and their replies, events, frames; it comes back by itself.
import { engineAddress } from "./address";
import { decodeFrame, type Frame } from "./frames";
import type { Protocol, Refusal, Reply } from "./messages";
import { waited } from "./waits";

type Request = Protocol["request"];
type Event = Protocol["event"];

type Numbered = Extract<Request, { id: number }>;
type WithoutNumber<R> = R extends unknown ? Omit<R, "id"> : never;

/** A request that the engine answers. */
export type Asking = WithoutNumber<Numbered>;

/** A request without an answer. */
export type Telling = Exclude<Request, Numbered>;

/** What a connection tells. */
export interface Listener {
  event(event: Event): void;
  frame(frame: Frame): void;
  /** The line is there, is gone and will be tried again, or the engine refused the document. */
  line(state: "open" | "lost" | "refused", problem?: string): void;
}

/** What the engine refused, and what is wrong with it. */
export class Refused extends Error {
  constructor(
    problem: string,
    /** What the problem is about, such as a parameter; null where that is not known. */
    readonly key: string | null,
  ) {
    super(problem);
  }

  /** What is wrong, without what it is about. */
  get words(): string {
    const start = `${this.key}: `;
    return this.message.startsWith(start) ? this.message.slice(start.length) : this.message;
  }
}

const FIRST_WAIT = 250; // ms
const LONGEST_WAIT = 4000; // ms

/** Whether an engine is there that does not know this page's token. */
async function isUnknown(): Promise<boolean> {
  const answer = await fetch(engineAddress("/")).catch(() => null);
  return answer?.status === 403;
}

/** A line to one document. */
export class Connection {
  private socket: WebSocket | null = null;
  private waiting = new Map<number, (reply: Reply) => void>();
  private number = 0;
  private wait = FIRST_WAIT;
  private closed = false;

  constructor(
    private readonly document: string,
    private readonly listener: Listener,
  ) {
    this.open();
  }

  /** Asks for something and waits for the reply. Rejects with `Refused`: what the engine says is wrong. */
  async ask(request: Asking, label: string): Promise<Reply> {
    const id = ++this.number;
    const coming = new Promise<Reply>((resolve) => {
      this.waiting.set(id, resolve);
      if (!this.send({ ...request, id } as Request)) this.fail(id);
    });
    const reply = await waited(label, coming);
    if (reply.problem !== null) throw new Refused(reply.problem, reply.key);
    return reply;
  }

  /** Tells something without waiting. */
  tell(request: Telling): void {
    this.send(request);
  }

  close(): void {
    this.closed = true;
    this.socket?.close();
  }

  private send(request: Request): boolean {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(request));
    return true;
  }

  private fail(id: number): void {
    const problem = "the engine does not answer; nothing was changed";
    const nothing = { key: null, cells: [], preview: null, answer: null };
    this.waiting.get(id)?.({ type: "reply", id, problem, ...nothing });
    this.waiting.delete(id);
  }

  private open(): void {
    const path = `/api/documents/${this.document}/socket`;
    const socket = new WebSocket(engineAddress(path, "ws"));
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    let refused = false;
    socket.onmessage = ({ data }) => {
      if (typeof data !== "string") {
        this.listener.frame(decodeFrame(data as ArrayBuffer));
        return;
      }
      const event = JSON.parse(data) as Event | Refusal;
      if (!("type" in event)) {
        refused = true;
        this.listener.line("refused", event.problem);
        return;
      }
      if (event.type === "welcome") {
        this.wait = FIRST_WAIT;
        this.listener.line("open");
      }
      if (event.type === "reply") {
        this.waiting.get(event.id)?.(event);
        this.waiting.delete(event.id);
      }
      this.listener.event(event);
    };
    socket.onclose = async () => {
      for (const id of [...this.waiting.keys()]) this.fail(id);
      if (this.closed || refused) return;
      this.listener.line("lost");
      const unknown = await isUnknown();
      if (this.closed) return;
      if (unknown) {
        this.listener.line("refused", "the engine was started anew; open the address it printed");
        return;
      }
      setTimeout(() => !this.closed && this.open(), this.wait);
      this.wait = Math.min(this.wait * 2, LONGEST_WAIT);
    };
  }
}
