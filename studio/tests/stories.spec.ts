// What people come to do, from the first click to the document that is left.
import type { Page } from "@playwright/test";
import { pictureOf, STRONGEST } from "./picture";
import {
  anchorPlace,
  cellAbove,
  clickCellAbove,
  converged,
  documentOf,
  expect,
  nextPicture,
  revisit,
  startStudio,
  still,
  test,
} from "./studio";

async function drag(
  page: Page,
  from: { x: number; y: number },
  dx: number,
  dy: number,
): Promise<void> {
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  for (let step = 1; step <= 8; step++)
    await page.mouse.move(from.x + (dx * step) / 8, from.y + (dy * step) / 8);
  await page.waitForTimeout(120);
  await page.mouse.up();
}

test("a designer pulls a net from the start page, and undoes it", async ({ page, open }) => {
  await open();
  await page.getByRole("button", { name: /^three cylinders A trunk/ }).click();
  await converged(page);
  const before = await documentOf(page);
  const drawn = await pictureOf(page);
  expect(drawn.colours).toBeGreaterThan(500);
  expect(drawn.lit).toBeGreaterThan(0.03);
  const most = await page.getByTestId("legend-high").textContent();

  const a7 = before.anchors.find(({ name }) => name === "A7")!;
  const lift = async (pixels: number) => {
    await page.keyboard.down("Shift");
    await drag(page, await anchorPlace(page, "A7"), 25, -pixels);
    await page.keyboard.up("Shift");
    await expect.poll(async () => (await documentOf(page)).position).toBe(1);
    const anchor = (await documentOf(page)).anchors.find(({ name }) => name === "A7")!;
    return anchor.position[2] - a7.position[2];
  };
  // Space pauses and runs; how far a pixel leads is found by a first try, which is undone.
  const perPixel = (await lift(90)) / 90;
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("Control+z");
  await expect.poll(async () => (await documentOf(page)).position).toBe(0);
  await converged(page);
  await page.keyboard.press("Space");
  await expect(page.getByRole("button", { name: "Run form-finding" })).toBeVisible();
  await page.keyboard.press("Space");
  expect(Math.abs((await lift(0.5 / perPixel)) - 0.5)).toBeLessThan(0.02);
  await converged(page);
  const moved = (await documentOf(page)).anchors.find(({ name }) => name === "A7")!;
  expect(moved.position[0]).toBe(a7.position[0]);
  expect(moved.position[1]).toBe(a7.position[1]);
  expect(moved.position[2]).toBeGreaterThan(a7.position[2] + 0.2);
  await expect(page.getByTestId("legend-high")).not.toHaveText(most!);
  expect((await pictureOf(page)).hash).not.toBe(drawn.hash);

  // To the millimetre, by typing.
  await page.mouse.move(500, 780);
  const place = await anchorPlace(page, "A7");
  await page.mouse.click(place.x, place.y);
  const z = page.getByRole("textbox", { name: "z" });
  await z.fill(String(a7.position[2] + 0.5));
  await z.press("Enter");
  await expect.poll(async () => (await documentOf(page)).position).toBe(2);
  await converged(page);
  expect(
    (await documentOf(page)).anchors.find(({ name }) => name === "A7")!.position[2],
  ).toBeCloseTo(a7.position[2] + 0.5, 9);

  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("Control+z");
  await page.keyboard.press("Control+z");
  await expect.poll(async () => (await documentOf(page)).position).toBe(0);
  expect((await documentOf(page)).anchors).toEqual(before.anchors);
  await page.keyboard.press("Control+Shift+z");
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  await page.reload();
  await converged(page);
  expect((await documentOf(page)).position).toBe(1);
  await expect(page.getByTestId("legend-high")).not.toHaveText(most!);
});

test("an architect relieves an anchor cell by cell", async ({ page, open }) => {
  await open("three-cylinders");
  // With a cross-section there is a stress.
  await page.getByLabel("Diameter ⌀").fill("2.5");
  await page.getByRole("button", { name: "Apply to all springs" }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  await converged(page);
  await still(page);
  const before = await documentOf(page);
  const anchor = await anchorPlace(page, "A4");
  // The reddest cord, where no node is nearer.
  const card = page.locator(".hover-card");
  for (const place of (await pictureOf(page)).nearest(STRONGEST).filter((_, at) => at % 9 === 0)) {
    await page.mouse.move(place.x, place.y);
    await nextPicture(page);
    if ((await card.count()) && (await card.textContent())?.startsWith("Spring")) break;
  }
  await expect(card).toContainText("Force");
  await expect(card).toContainText("LengthL");
  await expect(card).toContainText("Unstressed lengthL0");
  await expect(card).toContainText("F = k L");
  await expect(card).toContainText("N/mm²");
  const shown = Number(/ForceF([\d.]+) N/.exec((await card.textContent())!)![1]);
  expect(shown).toBeGreaterThan(0.9 * before.figures.force_max);
  const stress = Number(/Stressσ([\d.]+)/.exec((await card.textContent())!)![1]);
  expect(stress).toBeCloseTo(shown / ((Math.PI / 4) * 2.5 ** 2), 3);

  await clickCellAbove(page, anchor);
  await expect(page.getByRole("heading", { name: /^Cell \d+$/ })).toBeVisible();
  await page.keyboard.press("s");
  await expect
    .poll(async () => (await documentOf(page)).figures.springs)
    .toBeGreaterThan(before.figures.springs);
  await expect(page.getByRole("heading", { name: "4 cells" })).toBeVisible();
  const divided = await documentOf(page);
  await expect(
    page.locator(".fact", { hasText: "Force differential" }).locator(".fact-change"),
  ).toBeVisible();
  await page.getByRole("button", { name: "6 dynamic", exact: true }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(3);
  const typed = await documentOf(page);
  expect(typed.figures.springs).not.toBe(divided.figures.springs);

  await page.getByRole("tab", { name: "Cells" }).click();
  await expect(
    page.getByRole("treeitem", { selected: true }).filter({ hasText: "type 6" }),
  ).toHaveCount(4);
  await page.getByRole("tab", { name: "Net" }).click();
  await page.getByRole("button", { name: "Off", exact: true }).click();
  await expect
    .poll(async () => (await documentOf(page)).figures.springs)
    .toBe(before.figures.springs);
  await page.getByRole("button", { name: "On", exact: true }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(5);
  const again = (await documentOf(page)).figures;
  expect(again.force_differential).toBeCloseTo(typed.figures.force_differential!, 9);
  expect(again.force_max).toBeCloseTo(typed.figures.force_max, 9);
});

test("springs are cut and added by hand", async ({ page, open }) => {
  await open("one-cylinder-quad");
  const before = (await documentOf(page)).figures.springs;
  const anchor = await anchorPlace(page, "A1");
  await page.keyboard.press("n");
  await page.keyboard.press("a");
  await page.mouse.click(anchor.x, anchor.y);
  const other = await anchorPlace(page, "A5");
  await page.mouse.move(other.x, other.y);
  await page.mouse.click(other.x, other.y);
  await expect.poll(async () => (await documentOf(page)).figures.springs).toBe(before + 1);
  await converged(page);
  await page.keyboard.press("x");
  await page.mouse.click((anchor.x + other.x) / 2, (anchor.y + other.y) / 2);
  await expect.poll(async () => (await documentOf(page)).position).toBe(2);
  await page.keyboard.press("Control+z");
  await page.keyboard.press("Control+z");
  await expect.poll(async () => (await documentOf(page)).figures.springs).toBe(before);
});

test("form-finding pauses, steps, runs and starts anew", async ({ page, open }) => {
  await open("three-cylinders");
  await page.getByRole("button", { name: "Pause form-finding" }).click();
  const canvas = page.locator("main.viewport canvas");
  await canvas.focus();
  const before = await pictureOf(page);
  await page.getByRole("button", { name: "10 steps" }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  await expect(page.locator(".badge")).toHaveText("paused");
  await page.getByRole("button", { name: "Make one step" }).click();
  await expect(page.locator(".status-fact", { hasText: "step" })).toContainText("1");
  await page.getByRole("button", { name: "Run form-finding" }).click();
  await converged(page);
  expect((await pictureOf(page)).hash).not.toBe(before.hash);
});

test("two windows on one document stay the same", async ({ page, open, context }) => {
  await open("one-cylinder");
  const other = await context.newPage();
  await other.goto(page.url());
  await converged(other);
  await page.getByRole("button", { name: "One step", exact: true }).click();
  const label = (await documentOf(page)).history.at(-1)?.label ?? "";
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  await other.getByRole("tab", { name: "History" }).click();
  await expect(other.getByRole("listitem").last()).toContainText(label || "Seek stress");
  await converged(other);
  const counts = page.locator(".status-fact").last();
  await expect(other.locator(".status-fact").last()).toHaveText((await counts.textContent())!);
});

test("a killed studio has lost nothing that was done", async ({ page, open, home }) => {
  const studio = await open("one-cylinder");
  await page.getByRole("button", { name: "One step", exact: true }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  const before = await documentOf(page);
  const { port, hash } = new URL(page.url());
  await studio.kill();
  await expect(page.locator(".line-state")).toContainText("does not answer");
  const again = await startStudio(home, undefined, Number(port));
  await revisit(page, again, hash);
  await converged(page);
  const after = await documentOf(page);
  expect(after.figures).toEqual(before.figures);
  expect(after.history).toEqual(before.history);
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("Control+z");
  await expect.poll(async () => (await documentOf(page)).position).toBe(0);
  await again.kill();
});

test("undo and redo are done however fast they are asked for", async ({ page, visit }) => {
  await visit("sheet");
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("g");
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  const done = (await documentOf(page)).figures.springs;
  // No answer of the engine is waited for in between.
  for (const key of ["Control+z", "Control+Shift+z", "Control+z", "Control+Shift+z"])
    await page.keyboard.press(key);
  await expect(page.getByRole("button", { name: "Redo" })).toHaveAttribute("aria-disabled", "true");
  await converged(page);
  const { position, figures } = await documentOf(page);
  expect([position, figures.springs]).toEqual([1, done]);
});

test("keys pressed quickly one after the other find what those before them did", async ({
  page,
  visit,
}) => {
  await visit("three-cylinders");
  const error = page.locator('[data-sonner-toast][data-type="error"]');
  await clickCellAbove(page, await anchorPlace(page, "A4"));
  await expect(page.getByRole("heading", { name: /^Cell \d+$/ })).toBeVisible();
  // The page still shows the whole cell when the second one is pressed.
  for (const _ of [1, 2]) await page.keyboard.press("s");
  await expect(page.getByRole("heading", { name: "16 cells" })).toBeVisible();
  expect((await documentOf(page)).position).toBe(2);
  for (const key of ["m", "Control+z"]) await page.keyboard.press(key);
  await expect.poll(async () => (await documentOf(page)).length).toBe(3);
  await expect.poll(async () => (await documentOf(page)).position).toBe(2);
  // A spring can be cut once.
  await page.keyboard.press("Control+k");
  await page.keyboard.type("select the spring with the largest force");
  await page.keyboard.press("Enter");
  await expect(page.getByRole("heading", { name: "Spring", exact: true })).toBeVisible();
  for (const _ of [1, 2]) await page.keyboard.press("Delete");
  await expect(page.getByText("select one spring first")).toBeVisible();
  expect((await documentOf(page)).history.at(-1)!.label).toBe("Cut a spring");
  // What turns something on and off does so.
  await page.keyboard.press("p");
  await page.getByRole("tab", { name: "Evolve" }).click();
  await expect(page.getByRole("list", { name: "Pinned nets" }).getByRole("listitem")).toHaveCount(
    1,
  );
  await page.locator("main.viewport canvas").focus();
  for (const _ of [1, 2]) await page.keyboard.press("l");
  await expect(page.locator(".looking.live")).toContainText("paused");
  await page.getByRole("button", { name: "Discard" }).dblclick();
  await expect(page.locator(".looking.live")).toBeHidden();
  expect(await error.allTextContents()).toEqual([]);
});

test("a second stroke of the brush leaves alone what the first one divided", async ({
  page,
  visit,
}) => {
  // Whatever the engine says comes late, so that the page still shows the whole cell.
  let late = 0;
  await page.routeWebSocket(/\/socket/, (socket) => {
    const engine = socket.connectToServer();
    engine.onMessage((message) => setTimeout(() => socket.send(message), late));
  });
  await visit("three-cylinders");
  const cell = await cellAbove(page, await anchorPlace(page, "A4"));
  await page.keyboard.press("b");
  late = 1500;
  for (const _ of [1, 2]) {
    await page.mouse.move(cell.x + 1, cell.y);
    await page.mouse.down();
    await page.mouse.up();
  }
  await page.waitForTimeout(2 * late);
  // Now, since it would go away by itself.
  expect(await page.locator('[data-sonner-toast][data-type="error"]').count()).toBe(0);
  late = 0;
  await expect.poll(async () => (await documentOf(page)).position).toBeGreaterThan(0);
  await converged(page);
});
