// Files: opened by path, saved, saved under another name, found again; pictures and models that others can read.
import { execFileSync } from "node:child_process";
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "@playwright/test";
import { PNG } from "pngjs";
import { converged, documentOf, expect, still, test } from "./studio";

const BIN = join(import.meta.dirname, "../../.venv/bin");

/** What the command line says of a design file. */
function solved(file: string): { springs: number; force_max: number } {
  const words = ["solve", file, "--json"];
  return JSON.parse(execFileSync(join(BIN, "springform"), words).toString());
}

async function download(page: Page, item: string | RegExp): Promise<Buffer> {
  await page.getByRole("button", { name: /^Document/ }).click();
  const coming = page.waitForEvent("download");
  await page.getByRole("menuitem", { name: item }).click();
  return readFileSync(await (await coming).path());
}

test("a file is opened, saved, saved under another name and found again", async ({
  page,
  open,
  home,
}) => {
  const [file, other] = [join(home, "mine.toml"), join(home, "other.json")];
  execFileSync(join(BIN, "springform"), ["init", "one-cylinder", "--out", file]);
  await open();
  const path = page.getByLabel("Path of a design file or a run folder on this machine");
  await path.fill(join(home, "nothing.toml"));
  await page.getByRole("button", { name: "Open", exact: true }).click();
  await expect(page.locator("main.start").getByRole("alert")).toContainText("nothing.toml");
  await path.fill(file);
  await path.press("Enter");
  await converged(page);
  await expect(page.locator(".title")).toContainText("saved as mine.toml");
  const first = new URL(page.url()).hash.slice(1);

  await page.getByRole("button", { name: "One step", exact: true }).click();
  await expect(page.locator(".title")).toContainText("kept; mine.toml is older");
  const canvas = page.locator("main.viewport canvas");
  await canvas.focus();
  await page.keyboard.press("Control+s");
  await expect(page.locator(".title")).toContainText("saved as mine.toml");
  const { figures } = await documentOf(page);
  expect(solved(file).springs).toBe(figures.springs);
  expect(solved(file).force_max).toBeCloseTo(figures.force_max, 9);

  // What is there is not replaced unless it is asked for.
  writeFileSync(other, "not mine");
  await canvas.focus();
  await page.keyboard.press("Control+Shift+S");
  const target = page.getByLabel("Path on this machine");
  await target.fill(`${home}/no/such/folder/net.toml`);
  await page.getByRole("button", { name: "Save", exact: true }).click();
  await expect(page.getByRole("dialog").getByRole("alert")).toContainText("does not exist");
  await target.fill(other);
  await page.getByRole("button", { name: "Save", exact: true }).click();
  await expect(page.getByRole("dialog").getByRole("alert")).toContainText("exists");
  expect(readFileSync(other, "utf8")).toBe("not mine");
  await page.getByLabel("Replace a file that is there").check();
  await page.getByRole("button", { name: "Save", exact: true }).click();
  await expect(page.locator(".title")).toContainText("saved as other.json");
  expect(solved(other).springs).toBe(figures.springs);
  expect((await documentOf(page)).file).toBe(other);

  // Another document, and back by the list of recent ones.
  await page.getByRole("button", { name: "Open another document" }).click();
  await expect(page.getByRole("heading", { name: "Go on with" })).toBeVisible();
  await expect(page.locator(".recent li")).toContainText(["other.json"]);
  await page.getByRole("button", { name: /^sheet/ }).click();
  await converged(page);
  expect((await documentOf(page)).document).not.toBe(first);
  await page.getByRole("button", { name: /^Document/ }).click();
  await page.getByRole("menuitem", { name: "Recent" }).press("ArrowRight");
  await page.getByRole("menuitem", { name: /^other/ }).click();
  await expect.poll(() => new URL(page.url()).hash.slice(1)).toBe(first);
  await converged(page);
  // One step, and the name of the file.
  expect((await documentOf(page)).position).toBe(2);
  expect(existsSync(file)).toBe(true);
});

test("what is exported is what is seen, and others can read it", async ({ page, visit, home }) => {
  await visit("three-cylinders-quad");
  await page.getByRole("button", { name: "Finer: trunk" }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  await converged(page);
  await still(page);
  const { figures, anchors } = await documentOf(page);

  const canvas = page.locator("main.viewport canvas");
  const box = (await canvas.boundingBox())!;
  const picture = PNG.sync.read(await download(page, "Export a picture (PNG)"));
  // Twice as fine as the screen.
  expect([picture.width, picture.height]).toEqual([
    2 * Math.round(box.width),
    2 * Math.round(box.height),
  ]);
  const pixels = new Uint32Array(
    picture.data.buffer,
    picture.data.byteOffset,
    picture.data.length / 4,
  );
  expect(new Set(pixels).size).toBeGreaterThan(300);
  // With the scale of the legend, from one end of the palette to the other, where the drawing has it.
  const bar = Array.from({ length: 200 }, (_, at) => {
    const [x, y] = [2 * 25 + 2 * at, picture.height - 2 * 57];
    return pixels[y * picture.width + x];
  });
  expect(new Set(bar).size).toBeGreaterThan(100);
  // The canvas is as fine as before.
  const fineness = await canvas.evaluate((element: HTMLCanvasElement) => element.width);
  expect(fineness).toBe(Math.round(box.width));

  const drawing = (await download(page, "Export a drawing (SVG)")).toString();
  const parsed = await page.evaluate((text) => {
    const svg = new DOMParser().parseFromString(text, "image/svg+xml");
    const within = [...svg.querySelectorAll("#springs line")].filter((line) =>
      ["x1", "x2"].every((name) => {
        const x = Number(line.getAttribute(name));
        return x >= 0 && x <= Number(svg.documentElement.getAttribute("width"));
      }),
    );
    return {
      errors: svg.querySelectorAll("parsererror").length,
      springs: svg.querySelectorAll("#springs line").length,
      within: within.length,
      names: [...svg.querySelectorAll("#anchors text")].map((name) => name.textContent),
    };
  }, drawing);
  expect(parsed.errors).toBe(0);
  expect(drawing).toContain("Force [N]");
  expect(new Set(drawing.match(/stroke="#\w+"/g)).size).toBeGreaterThan(50);
  expect(parsed.springs).toBe(figures.springs);
  expect(parsed.within).toBe(figures.springs);
  expect(parsed.names).toEqual(anchors.map(({ name }) => name));

  // Kinds are explained one by one.
  await page.getByLabel("Colour springs by").selectOption("level");
  const kinds = page.locator(".kind-list > *");
  const named = (await download(page, "Export a drawing (SVG)")).toString();
  const legend = named.slice(named.indexOf('id="legend"'));
  expect(legend.match(/<rect/g)).toHaveLength(await kinds.count());
  expect(await kinds.count()).toBeGreaterThan(1);

  for (const [item, ending] of [
    [/TOML/, "toml"],
    [/JSON/, "json"],
  ] as const) {
    const file = join(home, `exported.${ending}`);
    writeFileSync(file, await download(page, item));
    expect(solved(file).springs).toBe(figures.springs);
    expect(solved(file).force_max).toBeCloseTo(figures.force_max, 9);
  }
  expect((await download(page, /ZIP/)).subarray(0, 2).toString()).toBe("PK");
  const lines = (await download(page, /OBJ/)).toString().split("\n");
  const places = lines
    .filter((line) => line.startsWith("v "))
    .map((line) => line.split(" ").slice(1).map(Number));
  expect(places).toHaveLength(figures.nodes);
  const lengths = lines
    .filter((line) => line.startsWith("l "))
    .map((line) =>
      line
        .split(" ")
        .slice(1)
        .map((node) => places[Number(node) - 1]),
    )
    .map(([a, b]) => Math.hypot(...a.map((value, axis) => value - b[axis])));
  expect(lengths).toHaveLength(figures.springs);
  expect(lengths.reduce((sum, length) => sum + length, 0)).toBeCloseTo(figures.total_length, 3);
});
