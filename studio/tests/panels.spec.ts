// Panels, keys and menus: all can be reached without a mouse, and by screen readers.
import type { Page } from "@playwright/test";
import { accessible, anchorPlace, cellAbove, converged, documentOf, expect, test } from "./studio";

test("no panel has serious findings of axe, dark or light", async ({ page, open }) => {
  await open();
  await page.locator(".scenes button").first().waitFor();
  await accessible(page);
  await page.getByRole("button", { name: /^three cylinders A trunk/ }).click();
  await converged(page);
  for (const theme of ["dark", "light"]) {
    for (const panel of ["Net", "Cells", "Framework", "Evolve", "Graft", "History"]) {
      await page.getByRole("tab", { name: panel }).click();
      await accessible(page);
    }
    await page.getByRole("button", { name: "Scale and palette" }).click();
    await accessible(page);
    await page.keyboard.press("Escape");
    await page.locator("main.viewport canvas").focus();
    for (const key of ["?", "Control+k", "Control+s"]) {
      await page.keyboard.press(key);
      await page.getByRole("dialog").waitFor();
      await accessible(page);
      await page.keyboard.press("Escape");
    }
    await states(page);
    if (theme === "dark") await page.keyboard.press("d");
  }
});

/** What appears only while something is selected or chosen. */
async function states(page: Page): Promise<void> {
  await page.getByRole("tab", { name: "Net" }).click();
  const anchor = await anchorPlace(page, "A4");
  await page.mouse.click(anchor.x, anchor.y);
  await page.getByLabel("Support").selectOption("plane");
  await accessible(page);
  await page.getByRole("button", { name: "Finer: trunk" }).hover();
  await page.locator(".preview-card").waitFor();
  await page.getByRole("combobox", { name: "Law", exact: true }).selectOption("curve");
  await accessible(page);
  await page.getByRole("button", { name: /^Document/ }).click();
  await page.getByRole("menu").waitFor();
  await accessible(page);
  await page.keyboard.press("Escape");
  await page.locator("main.viewport canvas").focus();
  for (const key of ["k", "t", "Shift+B"]) await page.keyboard.press(key);
  await accessible(page);
  for (const key of ["k", "t", "v", "Escape"]) await page.keyboard.press(key);
}

test("the framework is changed by form, and what is refused says why", async ({ page, visit }) => {
  await visit("one-cylinder");
  const before = (await documentOf(page)).figures;
  await page.getByRole("tab", { name: "Framework" }).click();
  const level = page.getByLabel("Level: every cell subdivided");
  await level.fill("1");
  await level.press("Enter");
  await page.getByRole("button", { name: "Apply" }).click();
  await expect
    .poll(async () => (await documentOf(page)).figures.springs)
    .toBeGreaterThan(2 * before.springs);
  // The form begins anew once the page knows the change.
  await expect(page.getByRole("button", { name: "Apply" })).toBeDisabled();
  await converged(page);
  const along = page.getByLabel("along", { exact: true });
  await along.fill("12");
  await along.press("Enter");
  const around = page.getByLabel("around", { exact: true });
  await around.fill("3");
  await around.press("Enter");
  await page.getByRole("button", { name: "Apply" }).click();
  // Anchors stand on vertices that a ring of three does not have.
  await expect(page.locator(".apply .problem")).toContainText("framework.anchors");
  expect((await documentOf(page)).position).toBe(1);
  await around.fill("24");
  await around.press("Enter");
  await page.getByRole("button", { name: "Apply" }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(2);
  await page.getByRole("button", { name: "Undo", exact: true }).click();
  await page.getByRole("button", { name: "Undo", exact: true }).click();
  await expect.poll(async () => (await documentOf(page)).figures).toEqual(before);
});

test("commands are found by name, and the menu by the right button", async ({ page, visit }) => {
  await visit("one-cylinder");
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("Control+k");
  await page.keyboard.type("seek stress, one");
  await page.keyboard.press("Enter");
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  await converged(page);
  const place = await anchorPlace(page, "A1");
  await page.mouse.click(place.x, place.y, { button: "right" });
  await page.getByRole("menuitem", { name: /^Let the anchor go/ }).click();
  await expect.poll(async () => (await documentOf(page)).anchors.length).toBe(7);
  await page.getByRole("tab", { name: "History" }).click();
  await page.getByRole("button", { name: "Start", exact: true }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(0);
});

test("every option says what it means, in the list and before it is taken", async ({
  page,
  visit,
}) => {
  await visit("three-cylinders");
  const silent = () =>
    page
      .locator("option")
      .evaluateAll((all) =>
        all
          .filter((option) => !option.querySelector("small")?.textContent)
          .map((option) => option.textContent),
      );
  let options = 0;
  await page.mouse.click(...(await onCell(page)));
  for (const panel of ["Net", "Framework", "Evolve", "Graft"]) {
    await page.getByRole("tab", { name: panel }).click();
    expect(await silent()).toEqual([]);
    options += await page.locator("option").count();
  }
  expect(options).toBeGreaterThan(40);
  await page.getByRole("tab", { name: "Net" }).click();
  const filter = page.getByLabel("Filter method");
  await filter.focus();
  await page.keyboard.press("Space");
  const told = filter.locator("option", { hasText: "Extensible" }).locator("small");
  await expect(told).toBeVisible();
  await expect(told).toHaveText(/^Cells of any levels meet/);
  // It stands below the name, and within the list.
  const [name, words] = await Promise.all([
    filter.locator("option", { hasText: "Extensible" }).locator("span").first().boundingBox(),
    told.boundingBox(),
  ]);
  expect(words!.y).toBeGreaterThanOrEqual(name!.y + name!.height - 1);
  await accessible(page);
  await page.keyboard.press("ArrowUp");
  await page.keyboard.press("Enter");
  await expect(filter).toHaveValue("extensible");
  await expect(filter.locator("button")).toHaveText("Extensible (QeT)");
  await expect(page.locator(".preview-card")).toContainText("Extensible");
});

async function onCell(page: Page): Promise<[number, number]> {
  const { x, y } = await cellAbove(page, await anchorPlace(page, "A4"));
  return [x, y];
}
