// How the net is seen: by quantities and kinds, scales and palettes, views; slack springs by their form.
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "@playwright/test";
import { conditionsOf, formed, PIECES } from "../src/document/conditions";
import type { Motion } from "../src/document/motion";
import { pictureOf } from "./picture";
import { converged, documentOf, expect, nextPicture, still, test } from "./studio";

const legend = (page: Page) => page.getByRole("region", { name: "Legend" });

/** Free rings that are three times as long as they are drawn. */
async function slacken(page: Page): Promise<void> {
  await page.getByRole("combobox", { name: "Of", exact: true }).selectOption("ring");
  await page.getByRole("combobox", { name: "Unstressed L0" }).selectOption("rest_ratio");
  await page.getByRole("textbox", { name: /^L0/ }).fill("3");
  await page.getByRole("button", { name: "Apply to free rings" }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  await converged(page);
}

test("slack springs are told by their form, whatever they are coloured by", async ({
  page,
  visit,
}) => {
  await visit("one-cylinder");
  await still(page);
  const taut = await pictureOf(page);
  await expect(legend(page)).not.toContainText("slack");
  await slacken(page);
  await still(page);
  // 16 diamonds around, whose halves at both ends have two ring edges each.
  const entry = legend(page).locator(".legend-entry", { hasText: "slack springs" });
  await expect(entry).toContainText("64");
  await expect(entry.locator("line")).toHaveCount(PIECES.slack.length);
  const slack = await pictureOf(page);
  expect(slack.hash).not.toBe(taut.hash);
  // The gaps of the dashes show the ground.
  expect(slack.lit).toBeLessThan(taut.lit);
  await page.getByLabel("Colour springs by").selectOption("part");
  await expect(entry).toContainText("64");

  await page.getByRole("button", { name: /^Document/ }).click();
  const coming = page.waitForEvent("download");
  await page.getByRole("menuitem", { name: "Export a drawing (SVG)" }).click();
  const drawing = readFileSync(await (await coming).path(), "utf8");
  const { springs } = (await documentOf(page)).figures;
  const pieces = springs + 64 * (PIECES.slack.length - 1);
  expect(drawing.match(/<line /g)).toHaveLength(pieces);
});

test("the pieces of a spring lie on it, and only springs without force fall to pieces", () => {
  const forces = new Float32Array([2, 0, Number.NaN, -1, 1e-12]);
  const conditions = conditionsOf({ forces } as Motion);
  expect([...conditions.numbers]).toEqual([0, 1, 2, 0, 1]);
  expect([conditions.slack, conditions.broken]).toEqual([2, 1]);
  const ends = Float32Array.from({ length: 30 }, (_, at) => Math.sin(7 * at));
  const colours = Uint8Array.from({ length: 15 }, (_, at) => at);
  const lines = { count: 5, ends, colours, widths: 2 };
  const { count, ...found } = formed(lines, conditions);
  expect(count).toBe(2 + 2 * PIECES.slack.length + PIECES.broken.length);
  const lengths = [0, 0, 0, 0, 0];
  for (let piece = 0; piece < count; piece++) {
    const spring = found.colours[3 * piece] / 3;
    const of = (all: Float32Array, at: number) => all.subarray(6 * at, 6 * at + 6);
    const [part, whole] = [of(found.ends, piece), of(ends, spring)];
    const along = whole.subarray(3).map((value, axis) => value - whole[axis]);
    const length = Math.hypot(...along);
    for (const end of [part.subarray(0, 3), part.subarray(3)]) {
      const off = end.map((value, axis) => value - whole[axis]);
      const share = off.reduce((sum, value, axis) => sum + value * along[axis], 0) / length ** 2;
      expect(share).toBeGreaterThan(-1e-5);
      expect(share).toBeLessThan(1 + 1e-5);
      expect(Math.hypot(...off.map((value, axis) => value - share * along[axis]))).toBeLessThan(
        1e-5,
      );
    }
    lengths[spring] +=
      Math.hypot(...part.subarray(3).map((value, axis) => value - part[axis])) / length;
    const widths = found.widths as Float32Array;
    if (conditions.numbers[spring] === 0) expect(widths[piece]).toBe(2);
    else expect(widths[piece]).toBeLessThan(2);
  }
  const drawn = (pieces: [number, number][]) =>
    pieces.reduce((sum, [from, to]) => sum + to - from, 0);
  const shares = [1, drawn(PIECES.slack), drawn(PIECES.broken), 1, drawn(PIECES.slack)];
  lengths.forEach((length, spring) => {
    expect(length).toBeCloseTo(shares[spring], 5);
  });
  const taut = { count: 2, ends, colours, widths: 2 };
  expect(formed(taut, conditionsOf({ forces: new Float32Array([1, 2]) } as Motion))).toBe(taut);
});

test("quantities, scales and palettes change picture and legend, nothing else", async ({
  page,
  visit,
}) => {
  await visit("three-cylinders-elastic");
  const before = await documentOf(page);
  const seen = new Set<number>();
  const look = async () => {
    await still(page);
    const { hash, colours } = await pictureOf(page);
    expect(seen.has(hash)).toBe(false);
    seen.add(hash);
    return colours;
  };
  await look();
  const words: [by: string, says: string][] = [
    ["density", "q = F / L"],
    ["length", "L between the end nodes"],
    ["strain", "ε = (L − L0) / L0"],
    ["part", "trunk"],
  ];
  for (const [by, says] of words) {
    await page.getByLabel("Colour springs by").selectOption(by);
    await expect(legend(page)).toContainText(says);
    await look();
  }
  await page.getByLabel("Colour springs by").selectOption("force");
  const high = page.getByTestId("legend-high");
  await expect(high).toContainText(before.figures.force_max.toPrecision(3));
  await page.getByRole("button", { name: "Scale and palette" }).click();
  const settings = page.getByRole("dialog", { name: "Scale and palette" });
  await settings.getByLabel("Logarithmic").check();
  await expect(legend(page)).toContainText("log");
  await look();
  await settings.getByLabel("Range").selectOption("percentile");
  await expect(legend(page)).toContainText("5–95 %");
  await expect(high).toContainText("≥");
  await look();
  await settings.getByLabel("Range").selectOption("fixed");
  await settings.getByLabel("To", { exact: true }).fill("5");
  await settings.getByLabel("To", { exact: true }).press("Enter");
  await expect(high).toHaveText("≥ 5 N");
  await look();
  const palettes = settings.getByLabel("Palette");
  const names = await palettes.locator("option").allTextContents();
  expect(names.length).toBeGreaterThan(1);
  await palettes.selectOption({ index: 1 });
  await look();
  await page.keyboard.press("Escape");
  // Views, thickness, what is shown beside the springs, and light.
  await page.locator("main.viewport canvas").focus();
  for (const key of ["w", "n", "t", "c", "d", "7", "1", "3"]) {
    await page.keyboard.press(key);
    await nextPicture(page);
    await look();
  }
  expect(await documentOf(page)).toEqual(before);
});

test("a measured curve is loaded from a CSV file for some springs", async ({
  page,
  visit,
  home,
}) => {
  await visit("one-cylinder");
  const before = await documentOf(page);
  const [good, bad] = [join(home, "cord.csv"), join(home, "torn.csv")];
  writeFileSync(good, "time [s];strain [%];force [N]\n0;0;0\n1;10;0,9\n2;20;1,4\n3;60;2,5\n");
  writeFileSync(bad, "strain [%],force [N]\n0,0\n10,twelve\n");
  await page.getByRole("combobox", { name: "Of", exact: true }).selectOption("ring");
  await page.getByRole("combobox", { name: "Law", exact: true }).selectOption("curve");
  const points = page.getByLabel(/^Points: strain, force/);
  const typed = await points.inputValue();
  const load = async (file: string) => {
    const chosen = page.waitForEvent("filechooser");
    await page.getByRole("button", { name: "Load a CSV file" }).click();
    await (await chosen).setFiles(file);
  };
  await load(bad);
  const toast = page.locator("[data-sonner-toast]", { hasText: "torn.csv:3" });
  await expect(toast).toContainText('the force is "twelve"; write a finite number');
  await expect(points).toHaveValue(typed);
  await load(good);
  await expect(page.locator(".curve-source")).toHaveText("4 points of cord.csv");
  await expect(points).toHaveValue("0, 0\n0.1, 0.9\n0.2, 1.4\n0.6, 2.5");
  await expect(page.getByRole("img", { name: /up to 2\.5 N at a strain of 0\.6/ })).toBeVisible();
  expect(await documentOf(page)).toEqual(before);
  await page.getByRole("button", { name: "Apply to free rings" }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  const after = await documentOf(page);
  expect(after.spring_groups.at(-1)).toEqual({
    title: "free rings",
    says: "a measured curve · L0 = 0.8 × drawn · tension",
  });
  expect(after.figures.force_max).not.toBeCloseTo(before.figures.force_max, 3);
});

test("the sheet of keys fits, and finds actions by word and by key", async ({ page, visit }) => {
  await visit("one-cylinder");
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("?");
  const sheet = page.getByRole("dialog", { name: "Keys and mouse" });
  const lines = sheet.locator(".sheet-line");
  const all = await lines.count();
  expect(all).toBeGreaterThan(60);
  const room = await sheet.locator(".sheet-columns").evaluate((columns) => ({
    hidden: columns.scrollHeight - columns.clientHeight,
    height: columns.closest("[role=dialog]")!.getBoundingClientRect().height,
  }));
  expect(room.hidden).toBeLessThanOrEqual(0);
  expect(room.height).toBeLessThanOrEqual(760);
  const search = sheet.getByLabel("Find an action or a key");
  await expect(search).toBeFocused();
  await page.keyboard.type("select");
  expect(await lines.count()).toBeLessThan(all / 2);
  for (const line of await lines.all()) await expect(line).toContainText(/select/i);
  await search.fill("j");
  await expect(lines).toHaveCount(1);
  await expect(lines).toContainText("Select cells of the same force");
  await search.fill("no such action");
  await expect(sheet.getByRole("status")).toContainText("No key or mouse action is called that");
  await page.keyboard.press("Escape");
  await expect(sheet).toBeHidden();
});

test("a net that is out of sight can be found again", async ({ page, visit }) => {
  await visit("three-cylinders");
  const canvas = page.locator("main.viewport canvas");
  await still(page);
  const lit = (await pictureOf(page)).lit;
  await canvas.hover();
  for (let turn = 0; turn < 60; turn++) await page.mouse.wheel(0, 900);
  const found = page.getByRole("button", { name: "Fit the net F" });
  await expect(page.getByText("The net is out of sight.")).toHaveCount(0);
  await page.mouse.down({ button: "middle" });
  await page.mouse.move(1900, 400, { steps: 5 });
  await page.mouse.up({ button: "middle" });
  await found.click();
  await expect(page.getByText("The net is out of sight.")).toHaveCount(0);
  await expect.poll(async () => (await pictureOf(page)).lit).toBeGreaterThan(0.6 * lit);
});
