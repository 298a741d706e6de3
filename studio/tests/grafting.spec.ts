// Grafting in the browser: cells are selected, copied as a patch, and set elsewhere.
import type { Page } from "@playwright/test";
import { PNG } from "pngjs";
import {
  anchorPlace,
  clickCellAbove,
  converged,
  documentOf,
  expect,
  nextPicture,
  test,
} from "./studio";

async function greenPixels(page: Page): Promise<number> {
  const { data } = PNG.sync.read(await page.locator("main.viewport").screenshot());
  let found = 0;
  for (let at = 0; at < data.length; at += 4)
    if (data[at] < 110 && data[at + 1] > 190 && data[at + 2] > 140 && data[at + 2] < 190) found++;
  return found;
}

/** Draws a lasso round a place [px]. */
export async function lasso(page: Page, x: number, y: number, radius: number): Promise<void> {
  await page.mouse.move(x + radius, y);
  await page.mouse.down();
  for (let step = 1; step <= 16; step++) {
    const angle = (2 * Math.PI * step) / 16;
    await page.mouse.move(x + radius * Math.cos(angle), y + radius * Math.sin(angle));
    await nextPicture(page);
  }
  await page.mouse.up();
}

/** What the engine's own files say of the design: nothing that the window reckons. */
async function netOf(page: Page) {
  const { hash, origin, search } = new URL(page.url());
  const file = async (name: string) => {
    const path = `/api/documents/${hash.slice(1)}/export/${name}`;
    return (await page.request.get(`${origin}${path}${search}`)).text();
  };
  const lines = (await file("obj")).split("\n").map((line) => line.split(" "));
  const places = lines.filter(([kind]) => kind === "v").map(([, ...place]) => place.map(Number));
  const springs = lines.filter(([kind]) => kind === "l").map(([, ...ends]) => ends.map(Number));
  const neighbours = places.map((): number[] => []);
  for (const [a, b] of springs) {
    neighbours[a - 1].push(b - 1);
    neighbours[b - 1].push(a - 1);
  }
  const { anchors } = await documentOf(page);
  const held = anchors.map(({ position }) =>
    places.findIndex((place) =>
      place.every((value, axis) => Math.abs(value - position[axis]) < 1e-9),
    ),
  );
  /** Nodes within three springs of a node. */
  const near = (node: number) => {
    const found = new Set([node]);
    for (let step = 0; step < 3; step++)
      for (const known of [...found]) for (const next of neighbours[known]) found.add(next);
    return found.size;
  };
  const ends = neighbours.map((others, node) => (held.includes(node) ? 2 : others.length));
  const { forest } = JSON.parse(await file("json")) as { forest?: { cells?: object } };
  return {
    springs: springs.length,
    dangling: ends.filter((count) => count < 2).length,
    near: held.map(near),
    /** Top-level cells that are not as the net began. */
    written: Object.keys(forest?.cells ?? {}).length,
  };
}

const row = (page: Page, name: string) =>
  page.locator(".comparison tr", { hasText: name }).locator("td");

test("a designer grafts a patch of an individual under every anchor", async ({ page, open }) => {
  test.setTimeout(120_000);
  await open("three-cylinders");
  await page.getByRole("tab", { name: "Evolve" }).click();
  for (const [label, value] of [
    ["Mutants a generation", "20"],
    ["End at generation", "12"],
    ["End at springs (0: never)", "0"],
  ]) {
    const field = page.getByLabel(label, { exact: true });
    await field.fill(value);
    await field.blur();
  }
  await page.getByRole("button", { name: "Evolve", exact: true }).click();
  await expect(page.locator(".section", { hasText: "Run" }).first()).toContainText("ended", {
    timeout: 60_000,
  });
  await page.getByRole("button", { name: "Pictures" }).click();
  await page.locator(".gallery-cell").first().click();
  await expect(page.locator(".looking")).toContainText("individual");
  const looking = (await documentOf(page)).looking!;
  await page.getByRole("tab", { name: "Graft", exact: true }).click();
  await converged(page);
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("Shift+L");
  const anchor = await anchorPlace(page, "A3");
  await lasso(page, anchor.x, anchor.y - 16, 44);
  await expect(page.getByLabel("Seen from")).toHaveValue("anchor A3");
  await page.getByRole("textbox", { name: "Name", exact: true }).fill("crown");
  await page.getByRole("button", { name: "Copy patch" }).click();
  const card = page.locator(".patch", { hasText: "crown" });
  await expect(card).toContainText(
    `generation ${looking.generation}, individual ${looking.individual}`,
  );

  // Another document: the base mesh. Patches are kept for all nets.
  await page.getByRole("button", { name: "Open another document" }).click();
  await page.getByRole("button", { name: /^three cylinders A trunk/ }).click();
  await converged(page);
  const before = await documentOf(page);
  expect(before.position).toBe(0);
  await page.getByRole("tab", { name: "Graft", exact: true }).click();
  const bare = await greenPixels(page);
  await page.getByRole("button", { name: "Graft crown" }).click();
  await page.getByRole("combobox", { name: "To", exact: true }).selectOption("anchors");
  await expect(page.locator(".comparison")).toBeVisible();
  // Turned by a step it is as whole as before: it turns no further than that.
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("r");
  await expect(page.getByRole("button", { name: "Rotate (1 of 2)" })).toBeVisible();
  await expect(page.locator(".comparison")).toBeVisible();
  await expect(page.locator(".panel-graft")).toContainText("24 of 24 top-level cells");
  await expect.poll(() => greenPixels(page)).toBeGreaterThan(bare + 300);
  const promised = Number((await row(page, "Springs").last().textContent())!.replace(",", ""));
  expect((await documentOf(page)).position).toBe(0);
  const bareNet = await netOf(page);
  expect(bareNet.written).toBe(0);

  await page.getByRole("button", { name: "Apply" }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  await converged(page);
  const after = await documentOf(page);
  expect(after.figures.springs).toBeGreaterThan(before.figures.springs);
  expect(after.figures.springs).toBe(promised);
  expect(after.history.at(-1)!.label).toBe("Graft crown in 12 places");
  const grafted = await netOf(page);
  expect(grafted.springs).toBe(promised);
  expect(grafted.dangling).toBe(0);
  // All anchors are alike, and so is what lies round them now.
  expect(grafted.near).toHaveLength(12);
  expect(new Set(grafted.near).size).toBe(1);
  expect(grafted.near[0]).toBeGreaterThan(bareNet.near[0]);
  expect(grafted.written % 12).toBe(0);
  expect(grafted.written).toBeGreaterThan(0);
  await page.getByRole("button", { name: "Undo", exact: true }).click();
  await expect.poll(async () => (await documentOf(page)).figures).toEqual(before.figures);
});

test("cells are selected by what they share, and edited as an orbit", async ({ page, open }) => {
  await open("three-cylinders");
  const title = page.locator(".section h2").first();
  await clickCellAbove(page, await anchorPlace(page, "A4"));
  await expect(title).toHaveText(/^Cell \d+$/);
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("]");
  await expect(title).toHaveText(/^\d+ cells$/);
  const grown = Number.parseInt((await title.textContent())!, 10);
  await page.keyboard.press("[");
  await page.keyboard.press("i");
  const cells = (await documentOf(page)).figures.cells;
  await expect(title).not.toHaveText(`${grown} cells`);
  await page.keyboard.press("Control+a");
  await expect(title).toHaveText(`${cells} cells`);
  await page.keyboard.press("Escape");
  await page.keyboard.press("o");
  const anchor = await anchorPlace(page, "A4");
  await page.mouse.click(anchor.x, anchor.y);
  await expect(title).toHaveText(/^\d+ cells$/);
  const ring = Number.parseInt((await title.textContent())!, 10);
  await page.mouse.click(anchor.x, anchor.y);
  await expect
    .poll(async () => Number.parseInt((await title.textContent())!, 10))
    .toBeGreaterThan(ring);

  await page.keyboard.press("Escape");
  await page.keyboard.press("y");
  await expect(page.locator(".lock-state")).toContainText("6 rotations and 6 mirrors");
  await clickCellAbove(page, anchor);
  const springs = (await documentOf(page)).figures.springs;
  await page.keyboard.press("s");
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  const after = await documentOf(page);
  expect(after.history.at(-1)!.label).toContain("symmetrically");
  expect(after.figures.springs).toBeGreaterThan(springs + 12);
  await page.keyboard.press("Control+z");
  await expect.poll(async () => (await documentOf(page)).figures.springs).toBe(springs);

  // Springs too, and stress-seeking.
  await converged(page);
  await page.keyboard.press("x");
  await page.mouse.click(anchor.x - 9, anchor.y - 34);
  await expect
    .poll(async () => (await documentOf(page)).history.at(-1)?.label)
    .toBe("Cut 12 springs, symmetrically");
  expect((await documentOf(page)).figures.springs).toBeLessThanOrEqual(springs - 12);
  await page.keyboard.press("Control+z");
  await expect.poll(async () => (await documentOf(page)).figures.springs).toBe(springs);
  await page.keyboard.press("v");
  await page.getByRole("tab", { name: "Net", exact: true }).click();
  await page.getByRole("button", { name: "One step", exact: true }).click();
  await expect
    .poll(async () => (await documentOf(page)).history.at(-1)?.label)
    .toBe("Seek stress, 1 step, symmetrically");
  expect((await documentOf(page)).figures.springs).toBeGreaterThan(springs + 12);
  await page.getByRole("tab", { name: "Graft", exact: true }).click();
  await expect(page.locator(".section", { hasText: "Symmetry" }).last()).not.toContainText(
    "The net does not",
  );
});
