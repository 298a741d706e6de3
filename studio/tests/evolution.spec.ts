// Evolution in the browser: a run is started, paused, changed, looked at, and taken over.
import type { Page } from "@playwright/test";
import { converged, documentOf, expect, revisit, startStudio, test } from "./studio";

async function fill(page: Page, label: string, value: string): Promise<void> {
  const field = page.getByLabel(label, { exact: true });
  await field.fill(value);
  await field.blur();
}

async function generations(page: Page): Promise<number> {
  return Number(
    (await page
      .locator(".fact", { hasText: /^Generations\d/ })
      .locator(".fact-value")
      .textContent())!.replace(",", ""),
  );
}

test("a researcher evolves, changes course, and takes a net over", async ({ page, open }) => {
  await open("three-cylinders");
  const before = await documentOf(page);
  await page.getByRole("tab", { name: "Evolve" }).click();
  await fill(page, "Mutants a generation", "20");
  await fill(page, "End at springs (0: never)", "0");
  await page.getByRole("button", { name: "Evolve", exact: true }).click();
  await expect(page.locator(".looking")).toContainText("Generation");
  await expect.poll(() => generations(page)).toBeGreaterThan(5);

  // The design is the designer's own until a net is taken over.
  expect((await documentOf(page)).position).toBe(0);
  await page.getByRole("button", { name: "Pause", exact: true }).click();
  await expect(page.getByRole("button", { name: "Continue" })).toBeVisible();
  await page.waitForTimeout(500);
  const paused = await generations(page);
  await page.getByText("Parameters of runs").click();
  await page.getByLabel("Cells subdivided").fill("5%");
  await page.getByRole("button", { name: "Change from now on" }).click();
  await page.getByRole("button", { name: "Continue" }).click();
  await expect.poll(() => generations(page)).toBeGreaterThan(paused + 2);
  await page.getByRole("button", { name: "Stop", exact: true }).click();
  await expect(page.locator(".section", { hasText: "Run" }).first()).toContainText("ended");
  await expect(
    page.getByRole("img", { name: /^Spring utilization factor over .*, now / }),
  ).toBeVisible();

  // Graphs take their colours with the page.
  const graph = page.locator(".panel-evolve .graph canvas").first();
  const drawn = () => graph.evaluate((canvas: HTMLCanvasElement) => canvas.toDataURL());
  await page.locator("main.viewport canvas").focus();
  const dark = await drawn();
  await page.keyboard.press("d");
  await expect.poll(drawn).not.toBe(dark);
  await page.keyboard.press("d");
  await expect.poll(drawn).toBe(dark);

  await page.getByRole("button", { name: "Pictures" }).click();
  const made = await generations(page);
  await expect(page.locator(".gallery header")).toContainText(
    `${(made * 20).toLocaleString("en")} in ${made} generations`,
  );
  const best = page.locator(".gallery-cell").first();
  await best.click();
  await expect(page.locator(".looking")).toContainText(`Generation ${made}, individual`);
  const shown = await documentOf(page);
  expect(shown.looking!.generation).toBe(made);
  await page.getByRole("button", { name: "Take over as my design" }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  await converged(page);
  const taken = await documentOf(page);
  expect(taken.looking).toBeNull();
  expect(taken.figures.springs).toBe(shown.figures.springs);
  expect(taken.figures.force_differential).toBeCloseTo(shown.figures.force_differential!, 9);
  await page.getByRole("button", { name: "Undo", exact: true }).click();
  await expect
    .poll(async () => (await documentOf(page)).figures.springs)
    .toBe(before.figures.springs);
});

test("a run outlives the studio", async ({ page, open, home }) => {
  const studio = await open("one-cylinder");
  await page.getByRole("tab", { name: "Evolve" }).click();
  await fill(page, "Mutants a generation", "10");
  await fill(page, "End at springs (0: never)", "0");
  await fill(page, "End at generation", "100000");
  await page.getByRole("button", { name: "Evolve", exact: true }).click();
  await expect.poll(() => generations(page)).toBeGreaterThan(3);
  await page.getByRole("button", { name: "Pause", exact: true }).click();
  await expect(page.getByRole("button", { name: "Continue" })).toBeVisible();
  // A page that draws in software hears of the last generations late.
  const stands = async () => {
    const before = await generations(page);
    await page.waitForTimeout(700);
    return (await generations(page)) === before;
  };
  await expect.poll(stands).toBe(true);
  const made = await generations(page);
  const { port, hash } = new URL(page.url());
  await studio.kill();
  const again = await startStudio(home, undefined, Number(port));
  await revisit(page, again, hash);
  await page.getByRole("tab", { name: "Evolve" }).click();
  await expect.poll(() => generations(page)).toBe(made);
  await page.getByRole("button", { name: "Continue" }).click();
  await expect.poll(() => generations(page)).toBeGreaterThan(made + 2);
  await again.kill();
});

test("fifty thousand individuals stay light", async ({ page, open }) => {
  test.setTimeout(240_000);
  await open("canopy");
  await page.getByRole("tab", { name: "Evolve" }).click();
  await fill(page, "Mutants a generation", "2500");
  await fill(page, "Cells subdivided", "1");
  await fill(page, "End at generation", "20");
  await fill(page, "End at springs (0: never)", "0");
  await page.getByRole("button", { name: "Evolve", exact: true }).click();
  await expect(page.locator(".section", { hasText: "Run" }).first()).toContainText("ended", {
    timeout: 200_000,
  });
  await page.getByRole("button", { name: "Pictures" }).click();
  await expect(page.locator(".gallery header")).toContainText("50,000 in 20 generations");
  const count = () => page.locator(".gallery *").count();
  expect(await count()).toBeLessThan(500);
  await page.locator(".gallery-box").evaluate((box) => box.scrollTo(90_000, 900));
  await expect(page.locator(".gallery-cell").first()).toBeVisible();
  expect(await count()).toBeLessThan(500);
});
