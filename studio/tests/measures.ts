// Not a test: times what people feel in a window, and prints it. Picking in a net of 20,000 springs, and the
// way from a pointer's move to the engine's new positions in a page (the picture is drawn in software here).
import type { Page } from "@playwright/test";
import * as THREE from "three";
import { type Motion, motionOf } from "../src/document/motion";
import { applyNet, type Net } from "../src/document/net";
import { decodeFrame } from "../src/protocol/frames";
import { Projection, pick } from "../src/viewport/picking";
import { anchorPlace, converged, documentOf, expect, test } from "./studio";

const ALL = { nodes: true, springs: true, cells: true };

/** Keeps the net that a page is sent, and where it is. */
function listen(page: Page): { net: Net | null; motion: Motion | null } {
  const kept: ReturnType<typeof listen> = { net: null, motion: null };
  page.on("websocket", (socket) => {
    socket.on("framereceived", ({ payload }) => {
      if (typeof payload === "string") return;
      const { header, arrays } = decodeFrame(new Uint8Array(payload).buffer);
      if (header.frame === "net") kept.net = applyNet(kept.net, header, arrays);
      if (header.frame === "motion") kept.motion = motionOf(header, arrays);
    });
  });
  return kept;
}

async function finer(page: Page, position: number): Promise<void> {
  await page.getByRole("button", { name: "Finer: whole net" }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(position);
  await converged(page);
}

function quantile(values: number[], share: number): number {
  return values.sort((a, b) => a - b)[Math.ceil(share * values.length) - 1];
}

test("picking at 20,000 springs", async ({ page, open }) => {
  const kept = listen(page);
  await open("three-cylinders-dense");
  await finer(page, 1);
  await finer(page, 2);
  const net = kept.net!;
  const motion = kept.motion!;
  const camera = new THREE.PerspectiveCamera(32, 1.25, 0.1, 100);
  const look = { motion, camera, width: 900, height: 720, section: null };
  camera.up.set(0, 0, 1);
  camera.position.set(6, -10, 6);
  camera.lookAt(0, 0, 2);
  camera.updateMatrixWorld();
  const cold: number[] = [];
  const warm: number[] = [];
  for (let at = 0; at < 300; at++) {
    const [x, y] = [(at * 37) % 900, (at * 53) % 720];
    const began = performance.now();
    const projection = new Projection(look);
    pick(net, projection, x, y, ALL);
    const between = performance.now();
    pick(net, projection, x + 1, y, ALL);
    cold.push(between - began);
    warm.push(performance.now() - between);
  }
  console.log(
    `picking in ${net.law.length} springs, ${net.nodes.length} nodes, ${net.addresses.length} cells: ` +
      `95 % within ${quantile(cold, 0.95).toFixed(2)} ms after the view changed, ` +
      `${quantile(warm, 0.95).toFixed(2)} ms in a view that stays`,
  );
});

test("a lasso in a page at 20,000 springs", async ({ page, open }) => {
  await open("three-cylinders-dense");
  await finer(page, 1);
  await finer(page, 2);
  await page.waitForTimeout(3000);
  const springs = (await documentOf(page)).figures.springs;
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("Shift+L");
  await page.mouse.move(880, 420);
  await page.mouse.down();
  const { moves, drop } = await page.evaluate(lassoRound, {
    x: 540,
    y: 420,
    radius: 340,
    steps: 240,
  });
  const title = await page.locator(".section h2").first().textContent();
  await page.mouse.up();
  console.log(
    `a lasso in ${springs} springs: 95 % of ${moves.length} moves within ${quantile(moves, 0.95).toFixed(1)} ms, ` +
      `the slowest ${Math.max(...moves).toFixed(1)} ms; ${title} selected in ${drop.toFixed(0)} ms`,
  );
});

/** In the page: draws a lasso, and tells how long the page was busy with every move and with the end [ms]. */
async function lassoRound(way: { x: number; y: number; radius: number; steps: number }) {
  const canvas = document.querySelector("main.viewport canvas")!;
  const point = (type: string, step: number) => {
    const angle = (2 * Math.PI * step) / way.steps;
    const clientX = way.x + way.radius * Math.cos(angle);
    const clientY = way.y + way.radius * Math.sin(angle);
    canvas.dispatchEvent(new PointerEvent(type, { clientX, clientY, bubbles: true, button: 0 }));
  };
  // From when the browser begins with the picture until it is done with it.
  const picture = () =>
    new Promise<number>((resolve) => {
      requestAnimationFrame(() => {
        const began = performance.now();
        const { port1, port2 } = new MessageChannel();
        port1.onmessage = () => resolve(performance.now() - began);
        port2.postMessage(null);
      });
    });
  const moves: number[] = [];
  for (let step = 1; step < way.steps; step++) {
    // Asked for first, so that its time begins before the page's own work for the picture.
    const done = picture();
    point("pointermove", step);
    moves.push(await done);
  }
  const began = performance.now();
  point("pointerup", way.steps - 1);
  const drop = performance.now() - began;
  await picture();
  return { moves, drop };
}

test("pointer to positions in a page at 3,000 springs", async ({ page, open }) => {
  await page.addInitScript(watchLine);
  await open("three-cylinders-quad");
  await finer(page, 1);
  const from = await anchorPlace(page, "A7");
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  for (let move = 0; move < 150; move++) {
    await page.mouse.move(from.x + 30 * Math.sin(move / 5), from.y - 40 + 20 * Math.cos(move / 7));
    await page.waitForTimeout(20 + (move % 7));
  }
  await page.mouse.up();
  const { whole, engine } = await page.evaluate(() => (globalThis as never as Watched).figures);
  console.log(
    `${whole.length} moves: from the pointer's event to new positions in the page, 95 % within ` +
      `${quantile(whole, 0.95).toFixed(1)} ms; of it from the request on ${quantile(engine, 0.95).toFixed(1)} ms`,
  );
});

interface Watched {
  figures: { whole: number[]; engine: number[] };
}

/** In the page: notes when the pointer moves, when the page asks, and when what it asked for is there. */
function watchLine(): void {
  const figures: Watched["figures"] = { whole: [], engine: [] };
  (globalThis as never as Watched).figures = figures;
  let moved = 0;
  let waiting: { moved: number; sent: number; place: number[] } | null = null;
  addEventListener(
    "pointermove",
    () => {
      moved = performance.now();
    },
    true,
  );
  const { send } = WebSocket.prototype;
  WebSocket.prototype.send = function (this: WebSocket, data) {
    const request = typeof data === "string" ? JSON.parse(data) : {};
    if (request.type === "hold" && !waiting)
      waiting = { moved, sent: performance.now(), place: request.position };
    send.call(this, data);
  };
  const listening = new WeakSet<WebSocket>();
  const NativeSocket = WebSocket;
  globalThis.WebSocket = class extends NativeSocket {
    constructor(address: string | URL, protocols?: string | string[]) {
      super(address, protocols);
      if (listening.has(this)) return;
      listening.add(this);
      this.addEventListener("message", ({ data }) => {
        if (!waiting || typeof data === "string") return;
        const buffer = data as ArrayBuffer;
        const length = new DataView(buffer).getUint32(0, true);
        const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
        if (header.frame !== "motion" || !header.held.length) return;
        const places = new Float32Array(buffer, 4 + length, header.arrays[0].length);
        const at = 3 * header.held[0];
        if (waiting.place.some((value, axis) => Math.abs(places[at + axis] - value) > 1e-4)) return;
        figures.whole.push(performance.now() - waiting.moved);
        figures.engine.push(performance.now() - waiting.sent);
        waiting = null;
      });
    }
  };
}
