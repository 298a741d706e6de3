// Selecting cells by mouse, by name and in the tree; what is selected is edited as one action.
import type { Page } from "@playwright/test";
import * as THREE from "three";
import type { Motion } from "../src/document/motion";
import type { Net } from "../src/document/net";
import { Projection, pick } from "../src/viewport/picking";
import { pictureOf } from "./picture";
import {
  anchorPlace,
  clickCellAbove,
  converged,
  documentOf,
  expect,
  nextPicture,
  still,
  test,
  undoTo,
} from "./studio";

const title = (page: Page) => page.locator(".section h2").first();

/** How many cells are selected, once that is another number than before. */
async function selected(page: Page, before = 0): Promise<number> {
  const count = async () => {
    const text = (await title(page).textContent())!;
    return /^Cell /.test(text) ? 1 : Number(/^(\d+) cells$/.exec(text)?.[1] ?? 0);
  };
  await expect.poll(count).not.toBe(before);
  return count();
}

/** Subdivides what is selected, and undoes it: as many cells come as were selected, three times. */
async function divides(page: Page, count: number): Promise<void> {
  const before = await documentOf(page);
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("s");
  await expect.poll(async () => (await documentOf(page)).position).toBe(before.position + 1);
  // The filters may divide neighbours, too.
  const { cells } = (await documentOf(page)).figures;
  expect(cells).toBeGreaterThanOrEqual(before.figures.cells + 3 * count);
  await undoTo(page, before.position);
  await converged(page);
}

async function command(page: Page, name: string): Promise<void> {
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("Control+k");
  await page.keyboard.type(name);
  await page.keyboard.press("Enter");
  await expect(page.getByRole("dialog")).toBeHidden();
}

test("a tool selects a row, a loop, a cylinder and a band of forces", async ({ page, visit }) => {
  await visit("three-cylinders-quad");
  const { cells } = (await documentOf(page)).figures;
  const anchor = await anchorPlace(page, "A4");
  // The trunk has 16 cells around and 6 along, and one above it 6 more; how many carry the same force is known to the net.
  const tools: [key: string, least: number, most: number][] = [
    ["Shift+Q", 16, 16],
    ["Shift+E", 12, 12],
    ["Shift+O", 96, 96],
    ["j", 1, cells - 1],
  ];
  for (const [key, least, most] of tools) {
    await page.locator("main.viewport canvas").focus();
    await page.keyboard.press("Escape");
    await expect(title(page)).toHaveText("Figures");
    await page.keyboard.press(key);
    await clickCellAbove(page, anchor);
    const count = await selected(page);
    expect(count).toBeGreaterThanOrEqual(least);
    expect(count).toBeLessThanOrEqual(most);
    await divides(page, count);
  }
  // By the palette the same, from one cell on.
  await page.keyboard.press("Escape");
  await clickCellAbove(page, anchor);
  await expect(title(page)).toHaveText(/^Cell \d+$/);
  await command(page, "extend the selection to rows");
  expect(await selected(page, 1)).toBe(16);
  await command(page, "extend the selection to cylinders");
  expect(await selected(page, 16)).toBe(96);
});

test("a box selects what is seen, and with Ctrl what is behind", async ({ page, visit }) => {
  await visit("three-cylinders");
  const { cells } = (await documentOf(page)).figures;
  await still(page);
  const bare = await pictureOf(page);
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("q");
  const box = (await page.locator("main.viewport").boundingBox())!;
  const drag = async () => {
    await page.mouse.move(box.x + 40, box.y + 70);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2, { steps: 3 });
    await expect(page.locator(".outline polygon")).toBeVisible();
    await page.mouse.move(box.x + box.width - 20, box.y + box.height - 20, { steps: 3 });
    // What lies over the net takes no part in the drag.
    await nextPicture(page);
    await page.mouse.up();
  };
  await drag();
  const front = await selected(page);
  expect(front).toBeGreaterThan(cells / 4);
  expect(front).toBeLessThan(cells);
  await still(page);
  expect((await pictureOf(page)).hash).not.toBe(bare.hash);
  await page.keyboard.down("Control");
  await drag();
  await page.keyboard.up("Control");
  expect(await selected(page, front)).toBe(cells);
  await divides(page, cells);
});

test("the cell under a point is the one in front of all that lie there", () => {
  let seed = 5;
  const random = () => {
    seed = (Math.imul(seed, 1103515245) + 12345) >>> 0;
    return seed / 2 ** 32;
  };
  const camera = new THREE.PerspectiveCamera(40, 1.25, 0.1, 100);
  camera.position.set(0, -6, 0.5);
  camera.lookAt(0, 0, 0);
  camera.updateMatrixWorld();
  const [width, height] = [800, 640];
  // Many small cells, and few that are larger than the canvas.
  for (const [count, size] of [
    [1500, 0.1],
    [40, 1.5],
    [6, 9],
  ]) {
    const places: number[] = [];
    for (let cell = 0; cell < count; cell++) {
      const [x, y, z] = [0, 0, 0].map(() => 4 * (random() - 0.5));
      for (const [dx, dz] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) // biome-ignore format: corners
        places.push(
          x + dx * size * random(),
          y + size * (random() - 0.5),
          z + dz * size * random(),
        );
    }
    const net = {
      addresses: Array.from({ length: count }, (_, cell) => String(cell)),
      boundaries: {
        starts: Int32Array.from({ length: count + 1 }, (_, cell) => 4 * cell),
        items: Int32Array.from({ length: 4 * count }, (_, node) => node),
      },
    } as Net;
    const motion = { positions: Float32Array.from(places) } as Motion;
    const projection = new Projection({ motion, camera, width, height, section: null });
    const { places: seen } = projection;
    const slow = (x: number, y: number) => {
      let [best, front] = [-1, 1];
      for (let cell = 0; cell < count; cell++) {
        const corners = [0, 1, 2, 3].map((corner) => 3 * (4 * cell + corner));
        if (corners.some((at) => seen[at + 2] > 1)) continue;
        const crossed = corners.filter((a, corner) => {
          const b = corners[(corner + 1) % 4];
          const [ax, ay, bx, by] = [seen[a], seen[a + 1], seen[b], seen[b + 1]];
          return ay > y !== by > y && x < ((bx - ax) * (y - ay)) / (by - ay) + ax;
        });
        const depth = corners.reduce((sum, at) => sum + seen[at + 2] / 4, 0);
        if (crossed.length % 2 && depth < front) [best, front] = [cell, depth];
      }
      return best < 0 ? null : best;
    };
    let hits = 0;
    for (let look = 0; look < 400; look++) {
      const [x, y] = [width * random(), height * random()];
      const found = pick(net, projection, x, y, { cells: true })?.row ?? null;
      expect(found).toBe(slow(x, y));
      hits += found === null ? 0 : 1;
    }
    expect(hits).toBeGreaterThan(10);
  }
});

test("the tree of cells and the view show the same", async ({ page, visit }) => {
  await visit("three-cylinders-quad");
  await clickCellAbove(page, await anchorPlace(page, "A4"));
  const cell = (await title(page).textContent())!.replace("Cell ", "");
  await page.getByRole("tab", { name: "Cells" }).click();
  const item = page.getByRole("treeitem", { selected: true });
  await expect(item).toHaveCount(1);
  await expect(item).toContainText(cell);
  await still(page);
  const one = await pictureOf(page);
  // From the tree to the view, by keys: up to the cylinder, close it, on to the next one.
  await item.focus();
  for (const key of ["ArrowLeft", "ArrowLeft", "ArrowDown", "Enter"])
    await page.keyboard.press(key);
  await expect(page.locator("[role=treeitem]:focus")).toContainText("left");
  await page.getByRole("tab", { name: "Net" }).click();
  expect(await selected(page, 1)).toBe(96);
  await still(page);
  expect((await pictureOf(page)).hash).not.toBe(one.hash);
});

test("a brush subdivides every cell that it passes, once", async ({ page, visit }) => {
  await visit("three-cylinders-quad");
  const before = (await documentOf(page)).figures;
  const { x, y } = await anchorPlace(page, "A4");
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("b");
  await page.mouse.move(x, y - 60);
  await page.mouse.down();
  for (const to of [-160, -60]) await page.mouse.move(x, y + to, { steps: 12 });
  await page.mouse.up();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  const { figures, history } = await documentOf(page);
  const count = Number(/(\d+) cells/.exec(history.at(-1)!.label)![1]);
  expect(count).toBeGreaterThan(1);
  expect(figures.cells).toBe(before.cells + 3 * count);
});
