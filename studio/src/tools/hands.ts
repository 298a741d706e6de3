// From pointer events on the canvas to the tool in the hand; what the tool leaves alone moves the eye.
import { notEditable } from "../document/editable";
import { notify, store, type ToolId } from "../document/store";
import type { Hit } from "../viewport/picking";
import type { Viewport } from "../viewport/scene";
import { Brushing } from "./brushing";
import { Grafting } from "./grafting";
import { Pulling } from "./pulling";
import { Gathering, Outlining, Ringing } from "./selecting";
import { Adding, Cutting } from "./springs";
import type { Pointer, Tool } from "./tool";
import { Weighing } from "./weighing";

const CLICK_REACH = 4; // px

/** Time between two moves of a direct drag [ms]; the engine makes no more than 60 steps a second by itself. */
const DIRECT_EVERY = 8;

/** Tools that edit the net. */
export const EDITING: ReadonlySet<ToolId> = new Set(["subdivide", "retype", "cut", "add"]);

/** A button that is down. */
interface Press {
  x: number;
  y: number;
  hit: Hit | null;
  taken: boolean;
  far: boolean;
}

/** Tells the tool what the pointer does. */
export class Hands {
  private readonly tools: Record<ToolId, Tool> = {
    pull: new Pulling(),
    subdivide: new Brushing("subdivide"),
    retype: new Brushing("retype"),
    cut: new Cutting(),
    add: new Adding(),
    weigh: new Weighing(),
    box: new Outlining(true),
    lasso: new Outlining(false),
    ring: new Ringing(),
    row: new Gathering("row"),
    loop: new Gathering("loop"),
    part: new Gathering("part"),
    band: new Gathering("band"),
    graft: new Grafting(),
  };
  private press: Press | null = null;
  private last: Pointer | null = null;
  private asked = 0;
  private direct = 0;
  private readonly ends: (() => void)[] = [];

  constructor(
    private readonly viewport: Viewport,
    private readonly canvas: HTMLCanvasElement,
  ) {
    this.listen(canvas, "pointerdown", (event) => this.down(event), true);
    this.listen(canvas, "pointermove", (event) => this.move(event));
    // What is dragged need not wait until the last picture is drawn, as Chromium's other events of moves do.
    this.listen(canvas, "pointerrawupdate", (event) => this.follow(event as PointerEvent));
    this.listen(canvas, "pointerup", (event) => this.up(event), true);
    this.listen(canvas, "pointercancel", () => this.cancel());
    this.listen(canvas, "pointerleave", () => this.leave());
    this.listen(window, "keydown", (event) => this.key(event));
    this.listen(window, "keyup", (event) => this.key(event));
    const stop = store.subscribe(({ tool }, before) => {
      if (tool === before.tool) return;
      this.tools[before.tool].cancel(this.viewport);
      this.canvas.style.cursor = this.tools[tool].cursor;
      if (!this.tool.brushes) store.setState({ brushAt: null });
    });
    this.ends.push(stop);
  }

  /** What lies under a point of the page, whatever the tool. */
  under(event: { clientX: number; clientY: number }): Hit | null {
    const { x, y } = this.place(event);
    return this.viewport.pick(x, y, { nodes: true, springs: true, cells: true });
  }

  cancel(): void {
    this.tool.cancel(this.viewport);
    this.press = null;
    this.viewport.eye.controls.enabled = true;
  }

  dispose(): void {
    for (const end of this.ends) end();
    cancelAnimationFrame(this.asked);
  }

  private get tool(): Tool {
    return this.tools[store.getState().tool];
  }

  /** Why the tool can't do its work now. */
  private refused(): string | null {
    const state = store.getState();
    return EDITING.has(state.tool) ? notEditable(state) : null;
  }

  private down(event: PointerEvent): void {
    if (event.button !== 0) return;
    const pointer = this.pointer(event);
    const hit = this.viewport.pick(pointer.x, pointer.y, this.tool.reach);
    const taken = this.refused() === null && this.tool.down(this.viewport, hit, pointer);
    this.press = { x: pointer.x, y: pointer.y, hit, taken, far: false };
    this.viewport.eye.controls.enabled = !taken;
    if (taken) this.canvas.setPointerCapture(event.pointerId);
    store.setState({ hover: null });
  }

  private move(event: PointerEvent): void {
    this.last = this.pointer(event);
    this.asked ||= requestAnimationFrame(() => {
      this.asked = 0;
      if (this.last) this.moved(this.last);
    });
  }

  private follow(event: PointerEvent): void {
    if (!this.press?.taken || !this.tool.direct) return;
    if (event.timeStamp < this.direct + DIRECT_EVERY) return;
    this.direct = event.timeStamp;
    this.last = this.pointer(event);
    this.dragged(this.press, this.last);
  }

  private dragged(press: Press, pointer: Pointer): void {
    press.far ||= Math.hypot(pointer.x - press.x, pointer.y - press.y) > CLICK_REACH;
    if (press.taken && press.far) this.tool.drag(this.viewport, this.dragHit(pointer), pointer);
  }

  private dragHit({ x, y }: Pointer): Hit | null {
    return this.tool.direct ? null : this.viewport.pick(x, y, this.tool.reach);
  }

  private moved(pointer: Pointer): void {
    if (this.tool.brushes) store.setState({ brushAt: [pointer.x, pointer.y] });
    if (this.press) {
      this.dragged(this.press, pointer);
      return;
    }
    const hit = this.viewport.pick(pointer.x, pointer.y, this.tool.reach);
    const { hover } = store.getState();
    if (hit?.kind !== hover?.kind || hit?.row !== hover?.row || hit) {
      const room: [number, number] = [this.canvas.clientWidth, this.canvas.clientHeight];
      store.setState({ hover: hit ? { ...hit, x: pointer.x, y: pointer.y, room } : null });
    }
    this.tool.hover(this.viewport, hit, pointer);
  }

  private up(event: PointerEvent): void {
    const { press } = this;
    if (!press || event.button !== 0) return;
    const pointer = this.pointer(event);
    this.press = null;
    this.viewport.eye.controls.enabled = true;
    const far = press.far || Math.hypot(pointer.x - press.x, pointer.y - press.y) > CLICK_REACH;
    if (far && press.taken) {
      this.tool.drag(this.viewport, this.dragHit(pointer), pointer);
      this.tool.drop(this.viewport, pointer);
    } else if (!far) {
      const refused = this.refused();
      if (refused !== null) notify(refused);
      else this.tool.click(this.viewport, press.hit, pointer);
    }
  }

  private leave(): void {
    this.last = null;
    store.setState({ brushAt: null });
    if (!this.press) store.setState({ hover: null });
  }

  /** Shift and Ctrl change where a drag leads, even if the pointer rests. */
  private key(event: KeyboardEvent): void {
    if (event.key === "Escape" && event.type === "keydown") this.cancel();
    if (!this.press?.taken || !this.press.far || !this.last) return;
    this.last = { ...this.last, shift: event.shiftKey, control: event.ctrlKey || event.metaKey };
    this.tool.drag(this.viewport, null, this.last);
  }

  private place(event: { clientX: number; clientY: number }): { x: number; y: number } {
    const box = this.canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  private pointer(event: PointerEvent): Pointer {
    const control = event.ctrlKey || event.metaKey;
    return { ...this.place(event), shift: event.shiftKey, control };
  }

  private listen<K extends keyof HTMLElementEventMap>(
    target: HTMLElement | Window,
    name: K,
    handle: (event: HTMLElementEventMap[K]) => void,
    capture = false,
  ): void {
    target.addEventListener(name, handle as EventListener, capture);
    this.ends.push(() => target.removeEventListener(name, handle as EventListener, capture));
  }
}
