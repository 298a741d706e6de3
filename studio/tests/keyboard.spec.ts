// The whole job without a mouse: from the start page to a net that was refined, moved, grafted, evolved and saved.
import { existsSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "@playwright/test";
import { converged, documentOf, expect, test } from "./studio";

/** Presses Tab until what has the focus is called so. */
async function tabTo(page: Page, name: RegExp, backwards = false): Promise<void> {
  const focused = () =>
    page.evaluate(() => {
      const element = document.activeElement as HTMLElement | null;
      const input = element as HTMLInputElement | null;
      const label = input?.labels?.[0]?.textContent;
      return (element?.getAttribute("aria-label") ?? label ?? element?.textContent ?? "").trim();
    });
  const seen: string[] = [];
  for (let press = 0; press < 150; press++) {
    const now = await focused();
    if (name.test(now)) return;
    seen.push(now.slice(0, 30));
    await page.keyboard.press(backwards ? "Shift+Tab" : "Tab");
  }
  throw new Error(`Tab does not lead to ${name}; it led to ${[...new Set(seen)].join(" | ")}`);
}

async function panel(page: Page, name: string): Promise<void> {
  await tabTo(page, /^(Net|Cells|Framework|Evolve|Graft|History)$/);
  const selected = page.getByRole("tab", { selected: true });
  for (let now = await selected.textContent(); now !== name; now = await selected.textContent()) {
    await page.keyboard.press("ArrowRight");
    await expect(selected).not.toHaveText(now!);
  }
}

async function command(page: Page, name: string): Promise<void> {
  await page.keyboard.press("Control+k");
  await page.keyboard.type(name);
  await page.keyboard.press("Enter");
  await expect(page.getByRole("dialog")).toBeHidden();
}

test("everything can be done by keys alone", async ({ page, open, home }) => {
  await open();
  await page.locator(".scenes button").first().waitFor();
  await tabTo(page, /^three cylinders ?A trunk/);
  await page.keyboard.press("Enter");
  await converged(page);
  const before = await documentOf(page);

  // A cell is found in the tree, and subdivided.
  await panel(page, "Cells");
  await tabTo(page, /^trunk\d+$/);
  for (const key of ["ArrowRight", "ArrowDown", "ArrowDown", "Enter"])
    await page.keyboard.press(key);
  await expect(page.getByRole("treeitem", { selected: true })).toHaveCount(1);
  await page.keyboard.press("s");
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  await converged(page);
  expect((await documentOf(page)).figures.cells).toBeGreaterThan(before.figures.cells);

  // What is selected now is copied as a patch, and set at all anchors.
  await panel(page, "Graft");
  await tabTo(page, /^Name/);
  await page.keyboard.press("Control+a");
  await page.keyboard.type("by_keys");
  await tabTo(page, /^Copy patch$/);
  await page.keyboard.press("Enter");
  await tabTo(page, /^Graft by_keys$/);
  await page.keyboard.press("Enter");
  await tabTo(page, /^To/);
  await page.keyboard.type("all anchors");
  await expect(page.locator(".comparison")).toBeVisible();
  await tabTo(page, /^Apply$/);
  await page.keyboard.press("Enter");
  await expect.poll(async () => (await documentOf(page)).position).toBe(2);
  await converged(page);

  // An anchor is found among the reactions, and moved by typing.
  await panel(page, "Net");
  await tabTo(page, /^A7$/);
  await page.keyboard.press("Enter");
  await expect(page.getByRole("heading", { name: "Anchor A7" })).toBeVisible();
  await tabTo(page, /^z/, true);
  await page.keyboard.press("Control+a");
  await page.keyboard.type("3.5");
  await page.keyboard.press("Enter");
  await expect.poll(async () => (await documentOf(page)).position).toBe(3);
  const moved = (await documentOf(page)).anchors.find(({ name }) => name === "A7")!;
  expect(moved.position[2]).toBe(3.5);

  // A run of a few generations; the best is taken over.
  await panel(page, "Evolve");
  await tabTo(page, /^Mutants a generation/);
  for (const value of ["10"]) {
    await page.keyboard.press("Control+a");
    await page.keyboard.type(value);
    await page.keyboard.press("Enter");
  }
  await tabTo(page, /^End at generation/);
  await page.keyboard.press("Control+a");
  await page.keyboard.type("4");
  await page.keyboard.press("Enter");
  await tabTo(page, /^Evolve$/);
  await page.keyboard.press("Enter");
  await expect(page.locator(".panel-evolve")).toContainText("ended");
  await expect(page.locator(".looking")).toContainText("Generation 4");
  await tabTo(page, /^Take over as my design$/);
  await page.keyboard.press("Enter");
  await expect.poll(async () => (await documentOf(page)).position).toBe(4);
  await converged(page);

  // Undone and done again, looked at from the top, saved.
  await page.keyboard.press("Control+z");
  await expect.poll(async () => (await documentOf(page)).position).toBe(3);
  await page.keyboard.press("Control+Shift+z");
  await expect.poll(async () => (await documentOf(page)).position).toBe(4);
  await command(page, "view from the top");
  await page.keyboard.press("Control+s");
  await page.keyboard.press("Control+a");
  await page.keyboard.type(join(home, "by-keys.toml"));
  await page.keyboard.press("Enter");
  await expect(page.locator(".title")).toContainText("saved as by-keys.toml");
  expect(existsSync(join(home, "by-keys.toml"))).toBe(true);
});

test("what is typed into the palette finds what it says", async ({ page, visit }) => {
  await visit("three-cylinders");
  await page.keyboard.press("Control+k");
  const items = page.locator("[cmdk-item]");
  const typed = async (words: string) => {
    await page.getByPlaceholder("What do you want to do?").fill(words);
    return items.first();
  };
  const marked = page.locator('[cmdk-item][data-selected="true"]');
  for (const [words, first] of [
    ["pin", "Pin what is shown, or unpin it"],
    ["history", "History: open its panel"],
    ["graft", "Graft: open its panel, with patches"],
    ["evolve", "Evolve live, or pause it"],
    ["EVOLVE: start", "Evolve: start a run"],
    ["framework", "Framework: open its panel"],
    ["top view", "View from the top"],
  ]) {
    await expect(await typed(words)).toContainText(first);
    await expect(marked).toContainText(first);
  }
  // What can't be done is said, and nothing else is taken for it.
  await expect(await typed("undo")).toContainText("nothing was done");
  await expect(items).toHaveCount(1);
  await expect(await typed("gallery")).toContainText("there is no run");
  await expect(items).toHaveCount(1);
  await expect(marked).toHaveCount(0);
  const last = async (words: string) => {
    await typed(words);
    return items.last();
  };
  await expect(await last("evolve")).toHaveAttribute("aria-disabled", "true");
  await expect(await last("graft")).toContainText("take a patch first");
  // Other words lead there as well; letters alone do not.
  await expect(await typed("rhino")).toContainText("Export: Lines at equilibrium (OBJ)");
  await expect(await typed("help")).toContainText("Show all keys");
  await typed("aplygrf");
  await expect(items).toHaveCount(0);

  await typed("history");
  await page.keyboard.press("Enter");
  await expect(page.getByRole("tab", { name: "History" })).toHaveAttribute("aria-selected", "true");
  await page.keyboard.press("Control+a");
  await command(page, "copy");
  await expect(page.getByRole("tab", { name: "Graft" })).toHaveAttribute("aria-selected", "true");
  await expect(page.locator(".patch-name").first()).toBeVisible();
  await command(page, "start a run");
  await expect(page.getByRole("tab", { name: "Evolve" })).toHaveAttribute("aria-selected", "true");
  await expect(page.getByRole("button", { name: "Start a new run" })).toBeVisible();
  await command(page, "pause the run");
  await expect(page.getByRole("button", { name: "Continue", exact: true })).toBeVisible();
  await command(page, "stop the run");
  await expect(page.locator(".section", { hasText: "Run" }).first()).toContainText("ended");
});
