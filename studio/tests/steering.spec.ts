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
  await expect(page.locator(".looking.live")).toHaveCount(0);
  // What did not change is no action.
  const better = differential < before.figures.force_differential! * 0.999;
  expect((await documentOf(page)).position).toBe(Number(better));
  await expect(page.locator("[data-sonner-toast]").last()).toContainText(
    better ? "Your design is now what grew" : "Nothing better grew",
  );
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

test("a parameter is mended and a run started by one press, and by a double press only one", async ({
  page,
  open,
}) => {
  await open("one-cylinder");
  await page.getByRole("tab", { name: "Evolve" }).click();
  const field = page.getByLabel("Mutants a generation", { exact: true });
  await page.getByLabel("End at generation", { exact: true }).fill("3");
  await field.fill("none");
  const start = page.getByRole("button", { name: "Evolve", exact: true });
  await start.click();
  const refused = page.locator(".panel-evolve").getByRole("alert");
  await expect(refused).toContainText("none");

  // What is typed stays while another panel is looked at.
  await page.getByRole("tab", { name: "Net" }).click();
  await page.getByRole("tab", { name: "Evolve" }).click();
  await expect(field).toHaveValue("none");

  // Nothing moves under the pointer between down and up.
  await field.fill("6");
  await expect(refused).toHaveCount(0);
  const before = (await start.boundingBox())!;
  await page.mouse.move(before.x + before.width / 2, before.y + 6);
  await page.mouse.down();
  expect((await start.boundingBox())!.y).toBe(before.y);
  await page.mouse.up();
  const runs = page.locator(".panel-evolve");
  await expect(runs.getByText("ended: the number of generations is reached")).toBeVisible();
  await expect(page.locator(".fact", { hasText: /^Generations3/ })).toBeVisible();

  await page.getByRole("button", { name: "Start a new run" }).dblclick();
  const list = page.getByRole("list", { name: "Runs of this document" });
  await expect(list.getByRole("button", { pressed: true })).toContainText("Run 2");
  await expect(runs.getByText("ended: the number of generations is reached")).toBeVisible();
  await page.waitForTimeout(500);
  await expect(list.getByRole("button")).toHaveCount(2);
});

test("a double press does not press what has come in the place of a button", async ({
  page,
  visit,
}) => {
  await visit("one-cylinder");
  await page.getByRole("tab", { name: "Evolve" }).click();
  await page.getByLabel("End at springs (0: never)").fill("0");
  const start = (await page.getByRole("button", { name: "Evolve", exact: true }).boundingBox())!;
  await page.mouse.click(start.x + 10, start.y + 10, { clickCount: 2, delay: 150 });
  await page.getByRole("button", { name: "Pause", exact: true }).dblclick({ delay: 150 });
  await expect(page.getByRole("button", { name: "Continue" })).toBeVisible();
  await page.waitForTimeout(300);
  await expect(page.getByRole("button", { name: "Continue" })).toBeVisible();
  await expect(page.getByRole("list", { name: "Runs of this document" })).toHaveCount(0);
  await page.getByRole("button", { name: "Stop", exact: true }).click();
});

test("a run that stands leads to its individuals, and what it cost is said", async ({
  page,
  visit,
}) => {
  await visit("three-cylinders");
  await page.getByRole("tab", { name: "Evolve" }).click();
  await run(page, 3);
  // What is looked at is not edited.
  await expect(page.locator(".tool-help")).toContainText("once you take it over");
  await expect(page.getByRole("button", { name: "Subdivide with a brush" })).toHaveAttribute(
    "aria-disabled",
    "true",
  );
  await page.getByRole("button", { name: "Look at individuals" }).click();
  await expect(page.locator(".gallery header")).toContainText("below: differential · springs");
  const bottom = async (what: string) => {
    const { y, height } = (await page.locator(what).boundingBox())!;
    return y + height;
  };
  expect(await bottom(".show-buttons")).toBeLessThan(await bottom("main.viewport"));

  const most = page.locator(".gallery-cell").first();
  await most.click();
  await expect(page.locator(".looking")).toContainText("individual");
  // Anchors have their names on both sides, and none is under a button.
  await page.keyboard.press("Shift+p");
  const names = page.locator(".anchor-names span", { hasText: /^A9$/ });
  await expect(names).toHaveCount(2);
  const buttons = (await page.locator(".view-buttons").boundingBox())!;
  for (const name of await names.all()) {
    const { x, y, width, height } = (await name.boundingBox())!;
    const beside = x + width < buttons.x || y + height < buttons.y;
    expect(beside).toBe(true);
  }
  await expect(page.getByRole("row", { name: /^Type 1 quad / })).toBeVisible();
  await page.keyboard.press("Escape");

  await page.getByRole("button", { name: "Take over as my design" }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  await converged(page);
  await page.getByRole("tab", { name: "Net" }).click();
  const figures = page.locator(".panel-net .fact");
  const differential = figures.filter({ hasText: "Force differential" }).locator(".fact-change");
  await expect(differential).toHaveText(/^\+/);
  await expect(differential).not.toHaveClass(/bad/);
  await expect(figures.filter({ hasText: "Spring utilization factor" })).toBeVisible();

  await page.getByRole("tab", { name: "History" }).click();
  await page.getByRole("img", { name: "branched from runs/0001" }).hover();
  await expect(page.getByRole("tooltip")).toContainText("Bred in runs/0001");

  await page.setViewportSize({ width: 900, height: 600 });
  const title = (await page.locator(".title").boundingBox())!;
  const undo = (await page.getByRole("button", { name: "Undo", exact: true }).boundingBox())!;
  const find = (await page.getByRole("button", { name: "Find a command" }).boundingBox())!;
  expect(title.x + title.width).toBeLessThanOrEqual(undo.x);
  expect(find.height).toBeLessThan(32);
});
