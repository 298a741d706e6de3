// Choosing among individuals: story five, pins, one sort key for all pictures, and two nets side by side.

import { execFileSync } from "node:child_process";
import { createHash } from "node:crypto";
import { join } from "node:path";
import type { Page } from "@playwright/test";
import { PNG } from "pngjs";
import { ranked } from "../src/document/choosing";
import { motionOf } from "../src/document/motion";
import { applyNet } from "../src/document/net";
import { decodeFrame } from "../src/protocol/frames";
import type { Compared } from "../src/protocol/messages";
import {
  accessible,
  converged,
  documentId,
  documentOf,
  expect,
  revisit,
  startStudio,
  still,
  test,
} from "./studio";

const BIN = join(import.meta.dirname, "../../.venv/bin");

function evolved(folder: string, ...words: string[]): string {
  const all = ["evolve", ...words, "--out", folder];
  execFileSync(join(BIN, "springform"), all, { stdio: "ignore" });
  return folder;
}

/** A net of the document as the engine has it: a hash of all of it, and where its nodes are. */
async function netOf(page: Page, side: string): Promise<{ hash: string; positions: Float32Array }> {
  const { origin, search } = new URL(page.url());
  const path = `${origin}/api/documents/${documentId(page)}/net/${side}${search}`;
  const body = await (await page.request.get(path)).body();
  const buffer = new Uint8Array(body).buffer;
  const length = new DataView(buffer).getUint32(0, true);
  const frames = [decodeFrame(buffer, 4), decodeFrame(buffer, 4 + length)];
  const [net, motion] = frames;
  if (net.header.frame !== "net" || motion.header.frame !== "motion") throw new Error("no net");
  const { nodes, ends } = applyNet(null, net.header, net.arrays);
  const { positions, forces } = motionOf(motion.header, motion.arrays);
  const digest = createHash("sha256").update(nodes.join(" "));
  for (const array of [ends, positions, forces])
    digest.update(new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
  return { hash: digest.digest("hex"), positions };
}

async function fill(page: Page, label: string, value: string): Promise<void> {
  const field = page.getByLabel(label, { exact: true });
  await field.fill(value);
  await field.blur();
}

/** What the labels of the pictures say, in their order on the page. */
async function pictured(page: Page): Promise<{ springs: number; differential: number }[]> {
  const labels = await page
    .locator(".gallery .gallery-cell")
    .evaluateAll((cells) => cells.map((cell) => cell.getAttribute("aria-label")!));
  return labels.map((label) => {
    const [, springs, differential] = label.match(
      /: ([\d,]+) springs, force differential ([\d.]+)/,
    )!;
    return { springs: Number(springs.replace(",", "")), differential: Number(differential) };
  });
}

test("a tutor brushes, clusters in 12, takes representative 5 over and pins it", async ({
  page,
  open,
  home,
}) => {
  const folder = evolved(
    join(home, "run"),
    ...["three-cylinders", "--population", "100", "--insertions", "2", "--types", "1,6"],
    ...["--until-springs", "2150", "--seed", "1"],
  );
  await open(folder);
  await page.getByRole("tab", { name: "Evolve" }).click();
  await fill(page, "Differential, at most", "20");
  await fill(page, "Springs, at least", "2001");
  const told = page.locator(".panel-evolve").getByText(/^[\d,]+ of [\d,]+ individuals/);
  const brushed = Number((await told.textContent())!.split(" ")[0].replace(",", ""));
  expect(brushed).toBeGreaterThan(12);
  await expect(
    page.getByRole("img", { name: new RegExp(`^${brushed} individuals by springs`) }),
  ).toBeVisible();
  await page.getByRole("button", { name: "Pictures" }).click();
  await expect(page.locator(".gallery header")).toContainText(`${brushed} in`);
  for (const { springs, differential } of await pictured(page)) {
    expect(springs).toBeGreaterThan(2000);
    expect(differential).toBeLessThanOrEqual(20);
  }
  await fill(page, "Groups", "12");
  await page.getByRole("button", { name: "Group", exact: true }).click();
  await expect(page.getByRole("button", { name: /^Representative/ })).toHaveCount(12);
  const representative = page.getByRole("button", { name: /^Representative 5 of/ });
  const [, generation, individual] = (await representative.getAttribute("aria-label"))!.match(
    /generation (\d+), individual (\d+)$/,
  )!;
  await representative.click();
  const name = `Generation ${generation}, individual ${individual}`;
  await expect(page.locator(".looking")).toContainText(name);
  const chosen = await netOf(page, `run/${generation}/${individual}`);
  await page.getByRole("button", { name: "Take over as my design" }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  await converged(page);
  expect((await netOf(page, "design")).hash).toBe(chosen.hash);
  await page.getByRole("button", { name: "Pin", exact: true }).click();
  await expect(page.getByRole("list", { name: "Pinned nets" })).toContainText(name);
  await expect(page.getByRole("button", { name: "Unpin", exact: true })).toBeVisible();
  expect((await netOf(page, "pin/1")).hash).toBe(chosen.hash);
  await page.getByRole("tab", { name: "History" }).click();
  const line = page.getByRole("listitem").filter({ hasText: `Take over ${name.toLowerCase()}` });
  await expect(line.getByRole("img", { name: /^branched from/ })).toBeVisible();
});

test("pins outlive the page and the studio, and all windows show the same", async ({
  page,
  open,
  home,
  context,
}) => {
  const folder = evolved(
    join(home, "run"),
    ...["one-cylinder", "--population", "12", "--generations", "6", "--insertions", "2"],
  );
  const studio = await open(folder);
  const other = await context.newPage();
  await other.goto(page.url());
  await converged(other);
  const strip = (window: Page) => window.getByRole("list", { name: "Pinned nets" });
  for (const window of [page, other]) await window.getByRole("tab", { name: "Evolve" }).click();
  await page.keyboard.press("u");
  const cells = page.locator(".gallery .gallery-cell");
  // By its button, by key and by menu.
  await cells.nth(1).hover();
  await page.locator(".gallery-pin").click();
  await expect(strip(other).getByRole("listitem")).toHaveCount(1);
  await cells.nth(3).focus();
  await page.keyboard.press("p");
  await expect(strip(other).getByRole("listitem")).toHaveCount(2);
  await cells.nth(5).click({ button: "right" });
  await page.getByRole("menuitem", { name: /^Pin/ }).click();
  await expect(strip(other).getByRole("listitem")).toHaveCount(3);
  await expect(strip(page).getByRole("listitem")).toHaveCount(3);
  const words = await strip(page).textContent();
  expect(words).toMatch(/Springs[\d,]+Differential[\d.]+SUF[\d.−e]+Area[\d.]+ m²/);
  await expect(strip(other)).toHaveText(words!);
  await page.getByRole("button", { name: "Pinned only" }).click();
  await expect(cells).toHaveCount(3);
  await page.reload();
  await converged(page);
  await page.getByRole("tab", { name: "Evolve" }).click();
  await expect(strip(page)).toHaveText(words!);
  const { port, hash } = new URL(page.url());
  await studio.kill();
  const again = await startStudio(home, undefined, Number(port));
  await revisit(page, again, hash);
  await page.getByRole("tab", { name: "Evolve" }).click();
  await expect(strip(page)).toHaveText(words!);
  await strip(page)
    .getByRole("button", { name: /^Unpin/ })
    .first()
    .click();
  await expect(strip(page).getByRole("listitem")).toHaveCount(2);
  await again.kill();
});

test("one sort key orders pictures, scatter and parallel coordinates", async ({
  page,
  open,
  home,
}) => {
  const folder = evolved(
    join(home, "run"),
    ...["one-cylinder", "--population", "20", "--generations", "8", "--insertions", "2"],
  );
  await open(folder);
  await page.getByRole("tab", { name: "Evolve" }).click();
  await page.keyboard.press("u");
  const gallery = page.locator(".gallery");
  await gallery.getByRole("button", { name: "A row a generation" }).click();
  await expect(gallery.locator("header")).toContainText("160 in 8 generations, ranked");
  const rising = (await pictured(page)).map(({ differential }) => differential);
  expect(rising).toEqual([...rising].sort((a, b) => a - b));
  const pictures = async () =>
    Promise.all(
      (await page.locator(".scatter canvas").all()).map((canvas) =>
        canvas.evaluate((element: HTMLCanvasElement) => element.toDataURL()),
      ),
    );
  await page.waitForTimeout(500);
  const before = await pictures();
  await gallery.getByLabel("Sorted by").selectOption("springs");
  await gallery.getByRole("button", { name: "The smallest first" }).click();
  await expect(page.getByRole("img", { name: /coloured by springs/ })).toHaveCount(2);
  await expect(page.locator(".rank-legend")).toContainText("first");
  await expect
    .poll(async () => (await pictures()).filter((one, at) => one !== before[at]).length)
    .toBe(2);
  const falling = (await pictured(page)).map(({ springs }) => springs);
  expect(falling).toEqual([...falling].sort((a, b) => b - a));
  await expect(page.locator(".panel-evolve").getByLabel("Sorted by")).toHaveValue("springs");
  // By the palette, too.
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("Control+k");
  await page.keyboard.type("sort individuals by total length");
  await page.keyboard.press("Enter");
  await expect(gallery.getByLabel("Sorted by")).toHaveValue("total_length");
});

test("a ranking is what sorting by value gives", () => {
  let seed = 7;
  const random = () => {
    seed = (Math.imul(seed, 1103515245) + 12345) >>> 0;
    return seed / 2 ** 32;
  };
  for (let round = 0; round < 40; round++) {
    const count = Math.floor(random() * 200);
    const value = () => (random() < 0.1 ? Number.NaN : Math.round((random() - 0.5) * 40) / 8);
    const suf = Float32Array.from({ length: count }, value);
    const springs = suf.map(() => 1);
    const individuals = { population: 10, springs, differential: springs, columns: { suf } };
    const mask = round % 2 ? Uint8Array.from(suf, () => (random() < 0.7 ? 1 : 0)) : null;
    const descending = round % 3 === 0;
    const { rows, known, place } = ranked(individuals, { by: "suf", descending }, mask);
    const slow = [...suf.keys()].filter((row) => !mask || mask[row]);
    const key = (row: number) =>
      Number.isNaN(suf[row]) ? Number.POSITIVE_INFINITY : descending ? -suf[row] : suf[row];
    slow.sort((a, b) => (key(a) === key(b) ? a - b : key(a) < key(b) ? -1 : 1));
    expect([...rows]).toEqual(slow);
    expect(known).toBe(slow.filter((row) => !Number.isNaN(suf[row])).length);
    for (const row of suf.keys()) expect(place[row]).toBe(slow.indexOf(row));
  }
});

/** Share of the left and of the right half of the canvas that is not ground, and a hash of each. */
async function halves(page: Page): Promise<{ lit: number; hash: number }[]> {
  await still(page);
  const picture = await page.locator("main.viewport").screenshot();
  const { data, width, height } = PNG.sync.read(picture);
  const pixels = new Uint32Array(data.buffer, data.byteOffset, width * height);
  const middle = Math.floor(width / 2);
  return [0, 1].map((half) => {
    const first = half * middle;
    const ground = pixels[(height - 120) * width + first + 4];
    let [lit, hash, all] = [0, 0, 0];
    // Headings, legend and buttons are no part of the nets.
    for (let y = 90; y < height - 90; y++)
      for (let x = first + 40; x < first + middle - 60; x++) {
        const pixel = pixels[y * width + x];
        if (pixel !== ground) lit++;
        hash = (Math.imul(hash, 31) + pixel) | 0;
        all++;
      }
    return { lit: lit / all, hash };
  });
}

test("two nets are compared side by side under one eye", async ({ page, open, home }) => {
  const folder = evolved(
    join(home, "run"),
    ...["three-cylinders", "--population", "12", "--generations", "8", "--insertions", "6"],
  );
  await open(folder);
  await page.getByRole("tab", { name: "Evolve" }).click();
  await page.keyboard.press("u");
  const cells = page.locator(".gallery .gallery-cell");
  const sides = [
    await cells.nth(0).getAttribute("data-side"),
    await cells.nth(9).getAttribute("data-side"),
  ];
  await cells.nth(0).click({ modifiers: ["Shift"] });
  await cells.nth(9).focus();
  await page.keyboard.press("m");
  await page.locator(".gallery").getByRole("button", { name: "Compare", exact: true }).click();
  const table = page.getByRole("table", { name: "Figures" });
  await expect(table).toBeVisible();

  const { origin, search } = new URL(page.url());
  const response = await page.request.post(
    `${origin}/api/documents/${documentId(page)}/compare${search}`,
    { data: { first: sides[0], second: sides[1] } },
  );
  const { first, second } = (await response.json()) as Compared;
  const row = (name: string) =>
    table
      .getByRole("row", { name: new RegExp(`^${name}`) })
      .getByRole("cell")
      .allTextContents();
  await expect(table.getByRole("row", { name: /^Springs/ }).getByRole("cell")).toHaveCount(3);
  const number = (text: string) => Number(text.replace(/,/g, "").replace("−", "-"));
  const [a, b, change] = (await row("Springs")).map(number);
  expect([a, b]).toEqual([first.figures.springs, second.figures.springs]);
  expect(change).toBe(b - a);
  const forces = (await row("Force differential")).map(number);
  expect(forces[0]).toBeCloseTo(first.figures.force_differential!, 1);
  expect(forces[1]).toBeCloseTo(second.figures.force_differential!, 1);
  expect(forces[2]).toBeCloseTo(
    second.figures.force_differential! - first.figures.force_differential!,
    1,
  );
  const reactions = page.getByRole("table", { name: "Reactions by anchor" });
  const { reactions: held } = (await response.json()) as Compared;
  await expect(reactions.getByRole("row")).toHaveCount(held.length + 1);
  const most = Math.max(first.figures.force_max, second.figures.force_max);
  expect(number((await page.getByTestId("shared-high").textContent())!.split(" ")[0])).toBeCloseTo(
    most,
    2,
  );

  await expect
    .poll(async () => (await halves(page)).filter(({ lit }) => lit > 0.02).length)
    .toBe(2);
  const before = await halves(page);
  expect(before[0].hash).not.toBe(before[1].hash);
  await accessible(page);
  // A drag over the left net turns the right one as well, by the same eye.
  const box = (await page.locator("main.viewport canvas").boundingBox())!;
  await page.mouse.move(box.x + 120, box.y + 200);
  await page.mouse.down();
  await page.mouse.move(box.x + 220, box.y + 240, { steps: 5 });
  await page.mouse.up();
  const turned = await halves(page);
  turned.forEach(({ hash, lit }, at) => {
    expect(hash).not.toBe(before[at].hash);
    expect(lit).toBeGreaterThan(0.02);
  });
  // What was left is right now, seen from where it was seen before.
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("s");
  await expect.poll(async () => (await row("Springs")).map(number)).toEqual([b, a, a - b]);
  const swapped = await halves(page);
  expect(swapped[0].lit).toBeCloseTo(turned[1].lit, 2);
  expect(swapped[1].lit).toBeCloseTo(turned[0].lit, 2);
  await page.getByRole("button", { name: "Pin net A" }).click();
  await page.getByRole("combobox", { name: "Net B" }).selectOption("design");
  await expect(page.getByRole("combobox", { name: "Net B" })).toHaveValue("design");
  const design = (await documentOf(page)).figures;
  await expect.poll(async () => (await row("Springs")).map(number)[1]).toBe(design.springs);
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("d");
  await accessible(page);
  await page.keyboard.press("Escape");
  await expect(table).toHaveCount(0);
  await expect(page.getByRole("list", { name: "Pinned nets" }).getByRole("listitem")).toHaveCount(
    1,
  );
  await accessible(page);
});

test("a comparison survives a reload and a restart, while its run is the one that is shown", async ({
  page,
  open,
  home,
}) => {
  const words = ["--population", "12", "--generations", "4", "--insertions", "2"];
  const studio = await open(evolved(join(home, "run"), "one-cylinder", ...words));
  await page.getByRole("tab", { name: "Evolve" }).click();
  await page.keyboard.press("u");
  const cells = page.locator(".gallery .gallery-cell");
  await cells.nth(0).click({ modifiers: ["Shift"] });
  await cells.nth(9).click({ modifiers: ["Shift"] });
  await page.keyboard.press("Shift+P");
  const figures = page.getByRole("table", { name: "Figures" });
  await expect(figures).toBeVisible();
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("s");
  const told = async () => {
    await expect(figures).toBeVisible();
    const chosen = page.getByRole("combobox", { name: /^Net [AB]$/ });
    const sides = await chosen.evaluateAll((all) =>
      all.map((one) => (one as HTMLSelectElement).value),
    );
    return { sides, figures: await figures.textContent() };
  };
  const before = await told();
  await page.reload();
  expect(await told()).toEqual(before);
  const { port, hash } = new URL(page.url());
  await studio.kill();
  const again = await startStudio(home, undefined, Number(port));
  await revisit(page, again, hash);
  expect(await told()).toEqual(before);
  // Closed stays closed.
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("Escape");
  await expect(figures).toBeHidden();
  await page.reload();
  await converged(page);
  await expect(figures).toBeHidden();
  expect(new URL(page.url()).hash).toBe(`#${documentId(page)}`);
  // Individuals of another run by the same numbers are others.
  await page.evaluate((to) => location.assign(to), hash.replace("run=", "run=other"));
  await expect(
    page.getByText("the individuals that were compared are of another run"),
  ).toBeVisible();
  await expect(figures).toBeHidden();
  await again.kill();
});

test("a pin is renamed by mouse and by keys, and stays so", async ({ page, visit }) => {
  await visit("one-cylinder");
  await page.keyboard.press("p");
  await page.getByRole("tab", { name: "Evolve" }).click();
  const pin = page.getByRole("list", { name: "Pinned nets" }).getByRole("listitem");
  const field = page.getByRole("textbox", { name: "Name of the pin" });
  await page.getByRole("button", { name: "Rename Design at the start" }).click();
  await expect(field).toBeFocused();
  await page.keyboard.type("Bare hall");
  await page.locator(".panel-evolve h2").first().click();
  await expect(pin).toContainText("Bare hall");
  // Tab leads to its picture; what is typed then is a name, not a command.
  await page.getByRole("button", { name: "Look at Bare hall" }).focus();
  await page.keyboard.press("F2");
  await page.keyboard.type("Ship");
  await page.keyboard.press("Enter");
  await expect(pin).toContainText("Ship");
  await expect(page.getByRole("button", { name: "Look at Ship" })).toBeFocused();
  await page.keyboard.press("F2");
  await page.keyboard.type("Nothing");
  await page.keyboard.press("Escape");
  await expect(field).toBeHidden();
  await accessible(page);
  await page.reload();
  await converged(page);
  await page.getByRole("tab", { name: "Evolve" }).click();
  await expect(pin).toContainText("Ship");
  expect((await documentOf(page)).position).toBe(0);
  expect((await documentOf(page)).looking).toBeNull();
});
