// What a designer relies on when nets evolve: parameters are obeyed, ends are ends, and no run is lost.
import type { Page } from "@playwright/test";
import { converged, documentOf, expect, revisit, startStudio, test } from "./studio";

async function run(page: Page, generations: number): Promise<void> {
  const parameters = page.getByText("Parameters of runs");
  const field = page.getByLabel("End at generation", { exact: true });
  if (!(await field.isVisible())) await parameters.click();
  await page.getByLabel("Mutants a generation", { exact: true }).fill("6");
  await field.fill(String(generations));
  await field.blur();
  await page.getByRole("button", { name: /^(Evolve|Start a new run)$/ }).click();
  await expect(page.locator(".section", { hasText: "Run" }).last()).toBeVisible();
  await expect(page.getByText("ended: the number of generations is reached")).toBeVisible();
}

test("live evolution obeys its parameters, and a discarded net comes back", async ({
  page,
  open,
}) => {
  await open("one-cylinder");
  const before = await documentOf(page);
  await page.getByRole("tab", { name: "Evolve" }).click();
  await page.getByText("Parameters of live evolution").click();
  const parameters = page.locator(".parameter-fold").first();
  await parameters.getByLabel("Best is the least").selectOption("differential");
  await parameters.getByLabel("The parent").selectOption("plus");
  await page.getByRole("button", { name: "Evolve live" }).click();
  await expect(page.locator(".section").first()).toContainText("No mutant was better in");
  const told = (await page.locator(".looking.live span").first().textContent())!;
  const differential = Number(told.replace(/.*force differential /, ""));
  expect(differential).toBeLessThanOrEqual(before.figures.force_differential! * 1.001);

  await page.getByRole("button", { name: "Discard" }).click();
  await expect(page.locator(".looking.live")).toHaveCount(0);
  await page.getByRole("button", { name: "Undo this" }).click();
  await expect(page.locator(".looking.live")).toContainText("Evolving live");
  await page.getByRole("button", { name: "Stop and keep" }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
});

test("an ended run stays ended over a restart, and earlier runs can be shown again", async ({
  page,
  open,
  home,
}) => {
  const studio = await open("one-cylinder");
  await page.getByRole("tab", { name: "Evolve" }).click();
  await run(page, 3);
  await run(page, 5);
  const runs = page.getByRole("list", { name: "Runs of this document" });
  await expect(runs.getByRole("button")).toHaveCount(2);
  await expect(runs.getByRole("button", { pressed: true })).toContainText("Run 2");
  await runs.getByRole("button", { name: /Run 1/ }).click();
  await expect(runs.getByRole("button", { pressed: true })).toContainText("Run 1");
  await expect(page.locator(".fact", { hasText: /^Generations3/ })).toBeVisible();

  const { port, hash } = new URL(page.url());
  await studio.kill();
  const again = await startStudio(home, undefined, Number(port));
  await revisit(page, again, hash);
  await converged(page);
  await page.getByRole("tab", { name: "Evolve" }).click();
  await expect(page.getByText("ended: the number of generations is reached")).toBeVisible();
  await expect(page.getByRole("button", { name: "Continue" })).toBeDisabled();
  await again.kill();
});
