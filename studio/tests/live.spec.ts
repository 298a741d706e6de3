// Live evolution in the browser: the net evolves while an anchor is dragged and cells are brushed.
import type { Page } from "@playwright/test";
import {
  anchorPlace,
  clickCellAbove,
  converged,
  documentOf,
  expect,
  revisit,
  startStudio,
  test,
} from "./studio";

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

test("its parameters are changed while it runs, and refused in the engine's words", async ({
  page,
  open,
}) => {
  await open("three-cylinders");
  await page.getByRole("tab", { name: "Evolve" }).click();
  const live = page.locator(".section", { hasText: "Live" }).first();
  await live.getByText("Parameters").click();
  const mutants = live.getByLabel("Mutants a generation");
  await expect(mutants).toHaveValue("100");
  await mutants.hover();
  await expect(page.getByRole("tooltip")).toContainText("the best of them is the next parent");
  await mutants.fill("0");
  await mutants.press("Enter");
  await expect(live.getByRole("alert")).toHaveText("must be greater than or equal to 1, not 0");
  await expect(mutants).toHaveAttribute("aria-invalid", "true");
  await mutants.fill("20");
  await mutants.press("Enter");
  await expect(live.getByRole("alert")).toHaveCount(0);
  await expect(live.locator("summary")).toContainText("1 changed");

  await live.getByRole("button", { name: "Evolve live" }).click();
  await expect.poll(() => generation(page)).toBeGreaterThan(3);
  const types = live.getByLabel("Types that are drawn");
  await types.fill("1,9");
  await types.press("Enter");
  await expect(live.getByRole("alert")).toHaveText(
    "there is no cell type '9'; use 0-6 or a defined name",
  );
  await types.press("Escape");
  await expect(types).toHaveValue("1,6");
  await expect(live.getByRole("alert")).toHaveCount(0);
  // What is set to its default isn't counted.
  await expect(live.locator("summary")).toContainText("1 changed");
  // A goal is a pause: it is passed by who goes on.
  const springs = (await documentOf(page)).figures.springs + 60;
  const goal = live.getByLabel("Pause at springs (0: never)");
  await goal.fill(String(springs));
  await goal.press("Enter");
  const banner = page.locator(".looking.live");
  await expect(banner).toContainText("the number of springs is reached");
  const reached = await generation(page);
  await banner.getByRole("button", { name: "Continue" }).click();
  await expect.poll(() => generation(page)).toBeGreaterThan(reached + 3);
  await live.getByLabel("Cells are drawn").selectOption("stress");
  await expect(live.locator("summary")).toContainText("3 changed");
  await page.reload();
  await page.getByRole("tab", { name: "Evolve" }).click();
  await live.getByText("Parameters").click();
  await expect(live.getByLabel("Cells are drawn")).toHaveValue("stress");
  await expect(mutants).toHaveValue("20");
  await live.getByRole("button", { name: "Back to the defaults" }).click();
  await expect(mutants).toHaveValue("100");
  await page.getByRole("button", { name: "Discard" }).click();
});

test("a killed studio takes the evolution up where it stood", async ({ page, open, home }) => {
  const studio = await open("three-cylinders");
  await page.getByRole("tab", { name: "Evolve" }).click();
  await page.getByRole("button", { name: "Keep out", exact: true }).click();
  await clickCellAbove(page, await anchorPlace(page, "A4"));
  await expect(page.locator(".brushes")).toContainText("1 brushed");
  await page.getByRole("button", { name: "Evolve live" }).click();
  await expect.poll(() => generation(page)).toBeGreaterThan(20);
  const before = await generation(page);
  const { port, hash } = new URL(page.url());
  await studio.kill();
  const again = await startStudio(home, undefined, Number(port));
  await revisit(page, again, hash);
  const banner = page.locator(".looking.live");
  await expect(banner).toContainText("taken up as it stood when the studio ended");
  // Nothing that was seen is missing.
  const taken = await generation(page);
  expect(taken).toBeGreaterThanOrEqual(before);
  await page.getByRole("tab", { name: "Evolve" }).click();
  await expect(page.locator(".brushes")).toContainText("1 brushed");
  await banner.getByRole("button", { name: "Continue" }).click();
  await expect.poll(() => generation(page)).toBeGreaterThan(taken + 3);
  await banner.getByRole("button", { name: "Keep" }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  await expect(banner).toHaveCount(0);
  await again.kill();
});
