// What the window tells while one works: figures of what is seen, forces of the hand, brushes, selections that stay.
import {
  anchorPlace,
  cellAbove,
  clickCellAbove,
  converged,
  documentOf,
  expect,
  nextPicture,
  test,
} from "./studio";

test("figures and the force of the hand follow a pull, and say so", async ({ page, visit }) => {
  await visit("three-cylinders");
  const figures = page.locator(".section", { has: page.getByRole("heading", { name: "Figures" }) });
  const largest = figures.locator(".fact", { hasText: "Largest force" }).locator(".fact-value");
  const resting = await largest.textContent();
  const anchor = await anchorPlace(page, "A9");
  const below = page.getByRole("heading", { name: "Springs", exact: true });
  const { y: still } = (await below.boundingBox())!;
  await page.mouse.move(anchor.x, anchor.y);
  await page.mouse.down();
  // What changes less than is shown has not changed; nothing in the panel moves.
  await page.mouse.move(anchor.x - 5, anchor.y, { steps: 3 });
  await expect(figures.locator(".fact-change").first()).toBeVisible();
  for (const change of await figures.locator(".fact-change").allTextContents())
    expect(change).not.toContain("e");
  expect((await below.boundingBox())!.y).toBe(still);
  await page.mouse.move(anchor.x - 40, anchor.y - 80, { steps: 6 });
  await expect(figures).toContainText("while pulled, against at rest");
  await expect(largest).not.toHaveText(resting!);
  await expect(page.locator(".pull-force")).toHaveText(/^[\d.]+ N$/);
  await page.mouse.up();
  await expect(page.locator(".pull-force")).toBeHidden();
  await converged(page);
  await expect(figures).not.toContainText("while pulled");
});

test("figures of a paused net are of what is seen", async ({ page, visit }) => {
  await visit("three-cylinders");
  const figures = page.locator(".section", { has: page.getByRole("heading", { name: "Figures" }) });
  await page.getByRole("button", { name: "Pause form-finding" }).click();
  const anchor = await anchorPlace(page, "A9");
  await page.mouse.move(anchor.x, anchor.y);
  await page.mouse.down();
  await page.mouse.move(anchor.x + 60, anchor.y - 120, { steps: 6 });
  await page.mouse.up();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  await expect(figures).toContainText("while paused, against at rest");
  const { force_max } = (await documentOf(page)).figures;
  const seen = (await page.getByTestId("legend-high").textContent())!;
  const value = figures
    .locator(".fact", { hasText: "Largest force" })
    .locator(".fact-value > span:not(.fact-change, .unit)");
  const told = Number(await value.textContent());
  expect(Math.abs(told - Number.parseFloat(seen))).toBeLessThan(0.01 * told);
  expect(Math.abs(told - force_max)).toBeGreaterThan(0.01 * told);
});

test("a cell has its inner force after one of its springs was changed", async ({ page, visit }) => {
  await visit("three-cylinders");
  await page.mouse.move(640, 700);
  const anchor = await anchorPlace(page, "A4");
  const cell = await cellAbove(page, anchor);
  await page.mouse.click(anchor.x - 9, anchor.y - 34);
  await expect(page.getByRole("heading", { name: "Spring", exact: true })).toBeVisible();
  await page.getByRole("textbox", { name: /^Stiffness k(?!,)/ }).fill("3");
  await page.getByRole("button", { name: "Apply to the selected spring" }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  await converged(page);
  await page.keyboard.press("Control+a");
  await expect(page.getByRole("heading", { name: /^\d+ cells$/ })).toBeVisible();
  const inner = page.locator(".fact", { hasText: "Inner force" }).locator(".fact-value");
  await expect(inner).toHaveText(/^\s*[\d.]+/);
  await page.mouse.move(cell.x, cell.y);
});

test("a selection keeps its place when cells are divided, undone and divided again", async ({
  page,
  visit,
}) => {
  await visit("three-cylinders");
  const cell = await cellAbove(page, await anchorPlace(page, "A4"));
  await page.mouse.click(cell.x, cell.y);
  for (const count of [4, 16]) {
    await page.keyboard.press("s");
    await expect(page.getByRole("heading", { name: `${count} cells` })).toBeVisible();
  }
  for (const keys of ["Control+z", "Control+z"]) await page.keyboard.press(keys);
  await expect.poll(async () => (await documentOf(page)).position).toBe(0);
  await expect(page.getByRole("heading", { name: /^Cell \d+$/ })).toBeVisible();
  for (const keys of ["Control+Shift+z", "Control+Shift+z"]) await page.keyboard.press(keys);
  await expect.poll(async () => (await documentOf(page)).position).toBe(2);
  await expect(page.getByRole("heading", { name: "16 cells" })).toBeVisible();
});

test("a brush is seen as large as it is, and takes what lies under it", async ({ page, visit }) => {
  await visit("three-cylinders");
  const cell = await cellAbove(page, await anchorPlace(page, "A4"));
  await page.mouse.click(cell.x, cell.y);
  await page.keyboard.press("Escape");
  await page.keyboard.press("b");
  await page.mouse.move(cell.x + 1, cell.y);
  const circle = page.locator(".brush-circle");
  const width = async () => (await circle.boundingBox())!.width;
  const small = await width();
  for (const _ of [1, 2]) await page.keyboard.press("]");
  expect(await width()).toBeGreaterThan(3 * small);
  await expect(page.locator(".hover-card")).toContainText("brush: subdivide");
  await page.mouse.down();
  await page.mouse.up();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  expect((await documentOf(page)).history[0].label).toMatch(/^Subdivide \d+ cells$/);
  await page.keyboard.press("[");
  await page.keyboard.press("[");
  expect(await width()).toBe(small);
});

test("a type is tried before it is given, and the card lies off the pointer", async ({
  page,
  visit,
}) => {
  await visit("three-cylinders");
  const cell = await cellAbove(page, await anchorPlace(page, "A4"));
  await nextPicture(page);
  const box = (await page.locator(".hover-card").boundingBox())!;
  expect(box.x > cell.x + 40 || box.y > cell.y + 40 || box.y + box.height < cell.y - 40).toBe(true);
  await expect(page.locator(".hover-card")).toContainText("1 quad");
  await page.mouse.click(cell.x, cell.y);
  await page.getByRole("button", { name: "6 dynamic", exact: true }).hover();
  await expect(page.locator(".preview-card")).toContainText("type 6 dynamic");
  await expect(page.locator(".preview-card")).toContainText("force differential");
  expect((await documentOf(page)).position).toBe(0);
});

test("frames of the focus are for those who move it by keys", async ({ page, visit }) => {
  await visit("three-cylinders");
  const outline = () => page.evaluate(() => getComputedStyle(document.activeElement!).outlineStyle);
  await page.getByRole("tab", { name: "Evolve" }).click();
  await page.keyboard.press("Shift");
  expect(await outline()).toBe("none");
  await page.keyboard.press("Tab");
  expect(await outline()).toBe("solid");
});

test("a banner covers nothing of the net", async ({ page, visit }) => {
  await visit("one-cylinder");
  await page.getByRole("tab", { name: "Evolve" }).click();
  await page.getByRole("button", { name: "Evolve live" }).click();
  const banner = page.locator(".looking.live");
  await banner.waitFor();
  const view = page.locator("main.viewport");
  await expect
    .poll(async () => {
      const [over, net] = [await banner.boundingBox(), await view.boundingBox()];
      return net!.y >= over!.y + over!.height;
    })
    .toBe(true);
  await page.keyboard.press("e");
  await expect(page.locator(".tool-help")).toBeVisible();
  await page.getByRole("tab", { name: "Net" }).click();
  await expect(page.getByText("of what grew, against my design")).toBeVisible();
  await banner.getByRole("button", { name: "Discard" }).click();
});

test("what is told hides nothing, can be put away, and goes with what it is about", async ({
  page,
  visit,
}) => {
  await visit("three-cylinders");
  const toasts = page.locator("[data-sonner-toast]");
  const refuse = async () => {
    await page.getByRole("textbox", { name: /^Stiffness k(?!,)/ }).fill("-1");
    await page.getByRole("button", { name: "Apply to all springs" }).click();
    await expect(toasts).toContainText("must be greater than 0");
  };
  await refuse();
  const under = () =>
    toasts.evaluate((toast) => {
      const { x, y, width, height } = toast.getBoundingClientRect();
      return document.elementFromPoint(x + width / 2, y + height / 2)?.tagName;
    });
  await expect.poll(under).toBe("CANVAS");
  await toasts.getByRole("button", { name: "Dismiss" }).click();
  await expect(toasts).toHaveCount(0);

  // The next action that succeeds ends what was said of the last.
  await refuse();
  await page.keyboard.press("g");
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  await expect(toasts).toHaveCount(0, { timeout: 1500 });

  await page.keyboard.press("Escape");

  // What is told of one document is no word on another.
  await refuse();
  await visit("one-cylinder");
  await expect(toasts).toHaveCount(0, { timeout: 1000 });
});

test("nothing is offered that would be refused while the net evolves", async ({ page, visit }) => {
  await visit("one-cylinder");
  const undo = page.getByRole("button", { name: "Undo", exact: true });
  const cut = page.getByRole("button", { name: "Cut springs" });
  const help = page.locator(".tool-help");
  await page.keyboard.press("g");
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  for (const button of [undo, cut])
    await expect(button).not.toHaveAttribute("aria-disabled", "true");
  await cut.click();
  await expect(help).toContainText("Click a spring to cut it.");
  await page.getByRole("tab", { name: "Evolve" }).click();
  await page.getByRole("button", { name: "Evolve live" }).click();
  await page.locator(".looking.live").waitFor();
  await expect(help).toContainText("Not now: the net evolves");
  for (const button of [undo, cut]) await expect(button).toHaveAttribute("aria-disabled", "true");
  const { x, y, width, height } = (await page.locator("main.viewport").boundingBox())!;
  await page.mouse.click(x + width / 2, y + height / 2);
  await expect(page.locator("[data-sonner-toast]")).toContainText("the net evolves");
  await page.keyboard.press("v");
  await expect(help).toContainText("Drag an anchor to move it while the net evolves");
  await page.locator(".looking.live").getByRole("button", { name: "Discard" }).click();
  await expect(undo).not.toHaveAttribute("aria-disabled", "true");
  await expect(help).toContainText("Drag a node to pull the net, an anchor to move it");
});

test("a coordinate that is refused is said by its name, and the field goes back", async ({
  page,
  visit,
}) => {
  await visit("one-cylinder");
  const anchor = await anchorPlace(page, "A2");
  await page.mouse.click(anchor.x, anchor.y);
  const field = page.getByRole("textbox", { name: /^x/ });
  const before = await field.inputValue();
  await field.fill("1e9");
  await field.press("Enter");
  await expect(page.locator("[data-sonner-toast]")).toContainText(
    "x: must be less than or equal to 1000000",
  );
  await expect(field).toHaveValue(before);
  await expect(page.locator(".busy")).toBeEmpty();
  expect((await documentOf(page)).position).toBe(0);
});

test("marks that were cleared can be brought back", async ({ page, visit }) => {
  await visit("three-cylinders");
  await page.getByRole("tab", { name: "Evolve" }).click();
  await page.getByRole("button", { name: "Keep out", exact: true }).click();
  await clickCellAbove(page, await anchorPlace(page, "A4"));
  await expect(page.locator(".brushes")).toContainText("1 brushed");
  await page.getByRole("button", { name: "Clear marks" }).click();
  await expect(page.locator(".brushes")).not.toContainText("brushed");
  await page.getByRole("button", { name: "Undo this" }).click();
  await expect(page.locator(".brushes")).toContainText("1 brushed");
});
