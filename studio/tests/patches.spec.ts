// Patches: turned over, renamed, deleted; and what is refused, with the engine's own words.
import { execFileSync } from "node:child_process";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "@playwright/test";
import {
  anchorPlace,
  cellAbove,
  clickCellAbove,
  converged,
  documentOf,
  expect,
  test,
} from "./studio";

const card = (page: Page, name: string) => page.locator(".patch", { hasText: name });

/** Copies the cells that are selected. */
async function copied(page: Page, name: string): Promise<void> {
  await page.getByRole("tab", { name: "Graft", exact: true }).click();
  await page.getByRole("textbox", { name: "Name", exact: true }).fill(name);
  await page.getByRole("button", { name: "Copy patch" }).click();
}

async function toast(page: Page, words: string | RegExp): Promise<void> {
  await expect(page.locator("[data-sonner-toast]", { hasText: words }).first()).toBeVisible();
}

test("the anchor that is worth copying is found", async ({ page, visit, home }) => {
  await visit("three-cylinders");
  // Two cells divided leave no symmetry, so that one anchor alone is the best.
  for (const [done, name] of ["A4", "A1"].entries()) {
    await clickCellAbove(page, await anchorPlace(page, name));
    await page.keyboard.press("s");
    await expect.poll(async () => (await documentOf(page)).position).toBe(done + 1);
    await converged(page);
  }
  const { hash, origin, search } = new URL(page.url());
  const path = `/api/documents/${hash.slice(1)}/export/toml${search}`;
  const design = join(home, "design.toml");
  writeFileSync(design, await (await page.request.get(`${origin}${path}`)).body());
  const words = ["patch", design, "--anchor", "best", "--out", join(home, "patch.toml"), "--json"];
  const springform = join(import.meta.dirname, "../../.venv/bin/springform");
  const patch = JSON.parse(execFileSync(springform, words).toString());
  await page.keyboard.press("Escape");
  await page.getByRole("tab", { name: "Graft", exact: true }).click();
  await page.getByRole("button", { name: "Rings round the best anchor" }).click();
  await expect(page.getByLabel("Seen from")).toHaveValue(`anchor ${patch.anchor}`);
});

test("a patch is turned over, renamed and deleted", async ({ page, visit }) => {
  await visit("three-cylinders-quad");
  const anchor = await anchorPlace(page, "A4");
  await clickCellAbove(page, anchor);
  await page.keyboard.press("s");
  await expect(page.getByRole("heading", { name: "4 cells" })).toBeVisible();
  // One of the four is divided again, so that the patch is not its own mirror image.
  await page.getByRole("tab", { name: "Cells" }).click();
  const children = page.getByRole("treeitem", { selected: true }).filter({ hasText: /^\d+\.\d/ });
  const face = (await children.first().textContent())!.split(".")[0];
  // Not the one at the anchor, which lies on the mirror.
  await children.nth(1).click();
  await expect(children).toHaveCount(1);
  await page.keyboard.press("s");
  await expect.poll(async () => (await documentOf(page)).position).toBe(2);
  await converged(page);
  await page
    .getByRole("treeitem")
    .filter({ hasText: new RegExp(`^${face}7$`) })
    .click();
  await copied(page, "askew");
  await expect(card(page, "askew")).toContainText("7 cells in 1");
  const { position, figures } = await documentOf(page);

  // Set elsewhere as it is, and turned over: the divided child lies on the other side.
  // Beside the springs that run up from the anchor.
  const other = await anchorPlace(page, "A2");
  const target = await cellAbove(page, { x: other.x + 14, y: other.y });
  const placed = async (mirror: boolean) => {
    await page.getByRole("button", { name: "Graft askew" }).click();
    await page.getByRole("combobox", { name: "To", exact: true }).selectOption("one");
    const button = page.getByRole("button", { name: "Mirror", exact: true });
    if (((await button.getAttribute("aria-pressed")) === "true") !== mirror) await button.click();
    await page.mouse.move(target.x + 1, target.y);
    await page.mouse.click(target.x, target.y);
    await expect(page.locator(".comparison")).toBeVisible();
    await page.locator(".panel-graft").getByRole("button", { name: "Apply" }).click();
    await expect.poll(async () => (await documentOf(page)).position).toBe(position + 1);
    await converged(page);
    const after = await documentOf(page);
    expect(after.figures.cells).toBe(figures.cells + 6);
    await page.getByRole("tab", { name: "Cells" }).click();
    const chosen = page.getByRole("treeitem", { selected: true });
    await expect(chosen.first()).toBeVisible();
    // The child that is divided again stands there with its number of cells.
    const deep = chosen.filter({ hasText: /^\d+\.\d4$/ });
    const child = (await deep.textContent())!.split(".")[1][0];
    await page.getByRole("tab", { name: "Graft", exact: true }).click();
    await page.getByRole("button", { name: "Undo", exact: true }).click();
    await expect.poll(async () => (await documentOf(page)).position).toBe(position);
    await converged(page);
    return child;
  };
  const plain = await placed(false);
  const mirrored = await placed(true);
  expect(plain).not.toBe(mirrored);

  await card(page, "askew").getByRole("button", { name: "Rename askew" }).click();
  await page.getByLabel("New name").fill("Not a name");
  await page.getByLabel("New name").press("Enter");
  await toast(page, /name/);
  await expect(card(page, "askew")).toBeVisible();
  await card(page, "askew").getByRole("button", { name: "Rename askew" }).click();
  await page.getByLabel("New name").fill("upright");
  await page.getByLabel("New name").press("Enter");
  await expect(card(page, "upright")).toContainText("7 cells in 1");
  await expect(card(page, "askew")).toHaveCount(0);
  await page.reload();
  await converged(page);
  await page.getByRole("tab", { name: "Graft", exact: true }).click();
  await expect(card(page, "upright")).toContainText("7 cells in 1");
  await page.getByRole("button", { name: "Delete upright" }).click();
  await expect(card(page, "upright")).toHaveCount(0);
});

test("what is refused is said in the engine's words, and nothing changes", async ({
  page,
  visit,
}) => {
  await visit("three-cylinders");
  const before = await documentOf(page);
  const canvas = page.locator("main.viewport canvas");

  // A name that is taken.
  await clickCellAbove(page, await anchorPlace(page, "A4"));
  await copied(page, "taken");
  await expect(card(page, "taken")).toBeVisible();
  await copied(page, "taken");
  await toast(page, /taken/);
  await expect(card(page, "taken")).toHaveCount(1);
  await page.getByRole("button", { name: "Delete taken" }).click();
  await expect(card(page, "taken")).toHaveCount(0);

  // Nothing lies below these cells that could be brought back.
  await canvas.focus();
  await page.keyboard.press("Shift+M");
  await toast(page, /./);
  await page.getByRole("tab", { name: "Net" }).click();

  await page.keyboard.press("Escape");
  await page.getByLabel("Stiffness k, F = k L").fill("-1");
  await page.getByLabel("Stiffness k, F = k L").press("Enter");
  await expect(page.getByLabel("Stiffness k, F = k L")).toHaveValue("1");

  // What is no number is not sent, and what is none to the engine is refused.
  await page.getByRole("combobox", { name: "Law", exact: true }).selectOption("force");
  await page.getByRole("textbox", { name: /^Constant force/ }).fill("none");
  await page.getByRole("button", { name: "Apply to all springs" }).click();
  await toast(page, /Constant force: “none” is no number/);
  await page.getByRole("textbox", { name: /^Constant force/ }).fill("1e400");
  await page.getByRole("button", { name: "Apply to all springs" }).click();
  await toast(page, /force/);
  expect(await documentOf(page)).toEqual(before);
});
