// Live evolution in the browser: the net evolves while an anchor is dragged and cells are brushed.
import type { Page } from "@playwright/test";
import { anchorPlace, clickCellAbove, converged, documentOf, expect, test } from "./studio";

async function generation(page: Page): Promise<number> {
  const words = (await page.locator(".looking.live b").textContent())!;
  return Number(words.replace(/.*generation /, "").replace(",", ""));
}

test("a net evolves before one's eyes, and what grew is kept as one action", async ({
  page,
  open,
}) => {
  await open("three-cylinders");
  const before = await documentOf(page);
  await page.getByRole("tab", { name: "Evolve" }).click();
  const picture = await page.locator("main.viewport canvas").screenshot();
  // Nothing grows where the brush says so.
  await page.getByRole("button", { name: "Keep out", exact: true }).click();
  await clickCellAbove(page, await anchorPlace(page, "A4"));
  await expect(page.locator(".brushes")).toContainText("1 brushed");
  await page.getByRole("button", { name: "Evolve live" }).click();
  await expect(page.locator(".looking.live")).toContainText("generations a second");
  await expect.poll(() => generation(page)).toBeGreaterThan(10);
  expect((await documentOf(page)).position).toBe(0);

  await page.getByRole("button", { name: "Select and pull" }).click();
  const anchor = await anchorPlace(page, "A9");
  await page.mouse.move(anchor.x, anchor.y);
  await page.mouse.down();
  await page.mouse.move(anchor.x - 40, anchor.y - 60, { steps: 5 });
  await page.mouse.up();
  const moved = await generation(page);
  await expect.poll(() => generation(page)).toBeGreaterThan(moved + 5);
  await page.getByRole("button", { name: "Stop and keep" }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  await converged(page);
  const after = await documentOf(page);
  expect(after.history[0].label).toMatch(/^Evolve live, \d+ generations$/);
  expect(after.figures.springs).toBeGreaterThan(before.figures.springs);
  const held = (state: typeof after) => state.anchors.find(({ name }) => name === "A9")!.position;
  expect(held(after)).not.toEqual(held(before));
  expect(await page.locator("main.viewport canvas").screenshot()).not.toEqual(picture);
  await page.getByRole("button", { name: "Undo", exact: true }).click();
  await expect
    .poll(async () => (await documentOf(page)).figures.springs)
    .toBe(before.figures.springs);
});

test("discarding returns to the start", async ({ page, open }) => {
  await open("one-cylinder");
  const before = await documentOf(page);
  await page.keyboard.press("l");
  await expect.poll(() => generation(page)).toBeGreaterThan(3);
  await page.getByRole("button", { name: "Discard" }).click();
  await expect(page.locator(".looking")).toHaveCount(0);
  await converged(page);
  expect(await documentOf(page)).toMatchObject({ position: 0, figures: before.figures });
});
