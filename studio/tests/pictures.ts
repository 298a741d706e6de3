// Takes the pictures of the documentation: every panel and state, into docs/pictures/studio.
import { rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "@playwright/test";
import { anchorPlace, clickCellAbove, converged, NETS, test } from "./studio";

const FOLDER = join(import.meta.dirname, "../../docs/pictures/studio");

async function take(page: Page, name: string): Promise<void> {
  // Until nothing moves, and what moved is drawn with its full width.
  await page.waitForTimeout(700);
  await page.screenshot({ path: join(FOLDER, `${name}.png`) });
}

test("start", async ({ page, open }) => {
  await open();
  await page.waitForTimeout(1500);
  await take(page, "start");
});

test("net", async ({ page, open }) => {
  await open("three-cylinders");
  const anchor = await anchorPlace(page, "A4");
  await page.mouse.move(anchor.x - 9, anchor.y - 34);
  await take(page, "spring");
  await clickCellAbove(page, anchor);
  await page.keyboard.press("s");
  await page.getByRole("heading", { name: "4 cells" }).waitFor();
  await converged(page);
  await take(page, "subdivided");
  await page.getByRole("tab", { name: "Cells" }).click();
  await take(page, "cells");
  await page.getByRole("tab", { name: "Net" }).click();
  await page.getByRole("button", { name: "10 steps" }).click();
  await converged(page);
  await page.getByRole("tab", { name: "History" }).click();
  await take(page, "history");
  await page.keyboard.press("Escape");
  await page.getByLabel("Colour springs by").selectOption("level");
  for (const key of ["c", "t", "w"]) await page.keyboard.press(key);
  await take(page, "skin");
});

test("hands", async ({ page, open }) => {
  await open("three-cylinders");
  const anchor = await anchorPlace(page, "A9");
  await page.mouse.move(anchor.x, anchor.y);
  await page.mouse.down();
  await page.mouse.move(anchor.x - 60, anchor.y - 90, { steps: 6 });
  await page.waitForTimeout(1200);
  await take(page, "pulling");
  await page.mouse.up();
  await page.mouse.move(640, 300);
  await page.mouse.click(640, 300, { button: "right" });
  await take(page, "menu");
});

test("overlays", async ({ page, open }) => {
  await open("one-cylinder-quad");
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("Control+k");
  await take(page, "palette");
  await page.keyboard.press("Escape");
  await page.keyboard.press("?");
  await take(page, "keys");
  await page.keyboard.press("Escape");
  const files = ["canopy", "atrium", "trunk-and-arms"].map((name) => join(NETS, `${name}.toml`));
  for (const file of files) writeFileSync(file, "");
  await page.keyboard.press("Control+s");
  await page.getByRole("button", { name: "canopy.toml" }).waitFor();
  await take(page, "save");
  for (const file of files) rmSync(file);
  await page.keyboard.press("Escape");
  await page.keyboard.press("d");
  await page.getByRole("button", { name: "Scale and palette" }).click();
  await take(page, "light");
});

test("evolution", async ({ page, open }) => {
  await open("three-cylinders");
  await page.getByRole("tab", { name: "Evolve" }).click();
  await take(page, "evolve-start");
  await page.getByRole("button", { name: "Evolve", exact: true }).click();
  await page.waitForTimeout(4000);
  await take(page, "evolving");
  await page.getByText("ended").waitFor({ timeout: 120_000 });
  await page.getByRole("button", { name: "Pictures" }).click();
  await page.waitForTimeout(2500);
  await page.locator(".gallery-cell").nth(2).click();
  await page.waitForTimeout(1500);
  await take(page, "gallery");
  await page.getByLabel("Differential, at most").fill("20");
  await page.getByLabel("Differential, at most").blur();
  await page.getByRole("button", { name: "Group", exact: true }).click();
  await page.getByLabel("Differential, at least").scrollIntoViewIfNeeded();
  await page.waitForTimeout(1500);
  await take(page, "choosing");
  await page.getByRole("heading", { name: "Clusters" }).scrollIntoViewIfNeeded();
  await page.locator(".lineage li button").nth(3).click();
  await take(page, "lineage");
});

test("choosing", async ({ page, open }) => {
  await open("three-cylinders");
  await page.getByRole("tab", { name: "Evolve" }).click();
  await page.getByRole("button", { name: "Evolve", exact: true }).click();
  await page.getByText("ended").waitFor({ timeout: 120_000 });
  await page.keyboard.press("u");
  await page.waitForTimeout(2500);
  for (const cell of [0, 4, 12]) {
    await page.locator(".gallery-cell").nth(cell).focus();
    await page.keyboard.press("p");
    await page.waitForTimeout(600);
  }
  await page.locator(".gallery-cell").nth(2).click();
  await page.getByRole("list", { name: "Pinned nets" }).scrollIntoViewIfNeeded();
  await page.waitForTimeout(1500);
  await take(page, "pinned");
  await page.locator(".gallery").getByRole("button", { name: "A row a generation" }).click();
  await page.locator(".gallery").getByLabel("Sorted by").selectOption("total_length");
  await page.getByLabel("Generation, at least").scrollIntoViewIfNeeded();
  await page.waitForTimeout(1500);
  await take(page, "ranking");
  await page.keyboard.press("Escape");
  await page.keyboard.press("Shift+P");
  await page.getByRole("table", { name: "Figures" }).waitFor();
  await take(page, "compare");
  await page.locator("main.viewport canvas").focus();
  for (const key of ["u", "d"]) await page.keyboard.press(key);
  await page.getByRole("combobox", { name: "Net A" }).selectOption({ index: 3 });
  await page.waitForTimeout(1500);
  await take(page, "compare-light");
});

test("framework", async ({ page, open }) => {
  await open("three-cylinders");
  await page.getByRole("tab", { name: "Framework" }).click();
  await take(page, "framework");
});

test("grafting", async ({ page, open }) => {
  await open("three-cylinders");
  await page.getByRole("tab", { name: "Graft", exact: true }).click();
  await take(page, "graft-start");
  const anchor = await anchorPlace(page, "A4");
  await clickCellAbove(page, anchor);
  await page.keyboard.press("s");
  await converged(page);
  await page.keyboard.press("Shift+L");
  await page.mouse.move(anchor.x + 60, anchor.y);
  await page.mouse.down();
  for (let step = 1; step <= 13; step++) {
    const angle = (2 * Math.PI * step) / 16;
    await page.mouse.move(anchor.x + 60 * Math.cos(angle), anchor.y - 30 + 70 * Math.sin(angle));
    await page.waitForTimeout(30);
  }
  await take(page, "lasso");
  await page.mouse.up();
  await take(page, "selected");
  await page.getByRole("textbox", { name: "Name", exact: true }).fill("crown");
  await page.getByRole("button", { name: "Copy patch" }).click();
  await page.getByRole("button", { name: "Graft crown" }).click();
  const other = await anchorPlace(page, "A9");
  await page.mouse.move(other.x + 2, other.y);
  await page.mouse.move(other.x, other.y);
  await take(page, "ghost");
  await page.getByRole("combobox", { name: "To", exact: true }).selectOption("anchors");
  await page.locator(".comparison").waitFor();
  await take(page, "graft-all");
  await page.getByRole("button", { name: "Apply" }).click();
  await converged(page);
  await page.keyboard.press("y");
  await take(page, "grafted");
  await page.keyboard.press("d");
  await take(page, "graft-light");
});

test("editing", async ({ page, open }) => {
  await open("three-cylinders");
  const anchor = await anchorPlace(page, "A4");
  await page.mouse.click(anchor.x - 9, anchor.y - 34);
  await page.mouse.move(640, 700);
  await page.getByRole("combobox", { name: "Law", exact: true }).selectOption("axial_stiffness");
  await page.getByRole("button", { name: "Apply to the selected spring" }).scrollIntoViewIfNeeded();
  await take(page, "law");
  await page.getByRole("combobox", { name: "Of", exact: true }).selectOption("part trunk");
  await page.getByRole("combobox", { name: "Law", exact: true }).selectOption("curve");
  await page.getByRole("button", { name: "Apply to trunk" }).click();
  await page.getByRole("button", { name: "Take back: trunk" }).waitFor();
  await converged(page);
  await page.getByLabel("Colour springs by").selectOption("strain");
  await page.getByRole("combobox", { name: "Of", exact: true }).selectOption("part trunk");
  await page.getByRole("button", { name: "Apply to trunk" }).scrollIntoViewIfNeeded();
  await take(page, "curve");
});

test("slack", async ({ page, open }) => {
  await open("one-cylinder");
  await page.getByRole("combobox", { name: "Of", exact: true }).selectOption("ring");
  await page.getByRole("combobox", { name: "Unstressed L0" }).selectOption("rest_ratio");
  await page.getByRole("textbox", { name: /^L0/ }).fill("3");
  await page.getByRole("button", { name: "Apply to free rings" }).click();
  await page.locator(".legend", { hasText: "slack" }).waitFor();
  await converged(page);
  await take(page, "slack");
});

test("supports", async ({ page, open }) => {
  await open("three-cylinders");
  const anchor = await anchorPlace(page, "A4");
  await page.mouse.click(anchor.x, anchor.y);
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("t");
  await page.getByLabel("Support").selectOption("line");
  await page.getByRole("button", { name: "Apply", exact: true }).click();
  await page.mouse.move(640, 700);
  await page.waitForTimeout(1500);
  await take(page, "supports");
  await page.getByRole("heading", { name: "Reactions" }).scrollIntoViewIfNeeded();
  await take(page, "reactions");
  const other = await anchorPlace(page, "A9");
  await page.mouse.move(other.x, other.y);
  await page.mouse.down();
  await page.keyboard.down("Control");
  await page.mouse.move(other.x + 40, other.y + 30, { steps: 6 });
  await page.waitForTimeout(900);
  await take(page, "level");
  await page.keyboard.up("Control");
  await page.mouse.up();
});

test("previews", async ({ page, open }) => {
  await open("three-cylinders-quad");
  await page.getByRole("button", { name: "Finer: trunk" }).hover();
  await page.locator(".preview-card").waitFor();
  await take(page, "density");
  await page.mouse.move(640, 700);
  const anchor = await anchorPlace(page, "A4");
  await clickCellAbove(page, anchor);
  await page.keyboard.press("s");
  await page.getByRole("heading", { name: "4 cells" }).waitFor();
  await page.keyboard.press("s");
  await page.getByRole("heading", { name: "16 cells" }).waitFor();
  await page.getByRole("combobox", { name: "Filter method" }).selectOption("recursive");
  await page.locator(".preview-card").waitFor();
  await take(page, "filters");
});

test("sections", async ({ page, open }) => {
  await open("three-cylinders");
  await page.locator("main.viewport canvas").focus();
  for (const key of ["k", "w"]) await page.keyboard.press(key);
  await page.getByRole("button", { name: "Section across x" }).click();
  await take(page, "section");
  await page.locator("main.viewport canvas").focus();
  for (const key of ["d", "Shift+B"]) await page.keyboard.press(key);
  await take(page, "brush-light");
  await page.keyboard.press("v");
  await page.keyboard.press("d");
  await page.getByRole("button", { name: /^Document/ }).click();
  await take(page, "document");
});

test("live", async ({ page, open }) => {
  await open("three-cylinders");
  await page.getByRole("tab", { name: "Evolve" }).click();
  await page.getByRole("button", { name: "Keep out", exact: true }).click();
  await clickCellAbove(page, await anchorPlace(page, "A4"));
  await page.getByRole("button", { name: "Grow here" }).click();
  await clickCellAbove(page, await anchorPlace(page, "A1"));
  await take(page, "live-start");
  await page.getByRole("button", { name: "Evolve live" }).click();
  await page.waitForTimeout(4000);
  await take(page, "live");
  const live = page.locator(".section", { hasText: "Live" }).first();
  await live.getByText("Parameters of live evolution").click();
  const mutants = live.getByLabel("Mutants a generation");
  await mutants.fill("0");
  await mutants.press("Enter");
  await live.getByRole("alert").waitFor();
  await live.getByLabel("Cells are drawn").hover();
  await page.getByRole("tooltip").waitFor();
  await live.locator("summary").evaluate((summary) => summary.scrollIntoView());
  await take(page, "live-parameters");
});
