// Not a test: `make bench CASES=studio` runs it to time what people feel in a window. Its nets and how often come
// as a file that SPRINGFORM_MEASURE names; figures go to another. The picture is drawn by whatever Chromium has.
import { readFileSync, writeFileSync } from "node:fs";
import type { Page } from "@playwright/test";
import { converged, expect, test } from "./studio";
import { type Figures, watch } from "./watch";

/** What to measure. */
interface Wanted {
  /** Design file of the net that is pulled for its delay, and of the large one. */
  pulled: string;
  large: string;
  /** Folder of the run whose individuals are scrolled through. */
  run: string;
  rounds: number;
  /** Moves of the pointer in a round. */
  moves: number;
  /** Where the figures go. */
  out: string;
}

const wanted = JSON.parse(readFileSync(process.env.SPRINGFORM_MEASURE!, "utf8")) as Wanted;

const EVERY = 1000 / 60; // ms between two moves of a pointer

const figures = async (page: Page): Promise<Figures> =>
  page.evaluate(() => (globalThis as never as { figures: Figures }).figures);

/** Moves the pointer as often as a mouse does, so far as Chromium takes the moves. */
async function wander(
  page: Page,
  moves: number,
  place: (move: number) => { x: number; y: number },
): Promise<void> {
  let next = performance.now();
  for (let move = 0; move < moves; move++) {
    const { x, y } = place(move);
    await page.mouse.move(x, y);
    next = Math.max(next + EVERY, performance.now());
    await page.waitForTimeout(next - performance.now());
  }
}

/** The anchor whose name stands nearest to the middle of the canvas [px]. */
async function anchorInSight(page: Page): Promise<{ x: number; y: number }> {
  await page.locator(".anchor-names span").first().waitFor();
  return page.locator("main.viewport").evaluate((viewport) => {
    const { left, top, width, height } = viewport.getBoundingClientRect();
    const [x, y] = [left + width / 2, top + height / 2];
    const places = [...viewport.querySelectorAll(".anchor-names span:not([hidden])")].map(
      (name) => {
        const box = name.getBoundingClientRect();
        // A name stands 9 px right of its anchor and 20 px above it.
        return { x: box.left - 9, y: box.top + 20 };
      },
    );
    const far = (place: { x: number; y: number }) => Math.hypot(place.x - x, place.y - y);
    return places.reduce((best, place) => (far(place) < far(best) ? place : best));
  });
}

/** Presses the button on an anchor once the net stands still [px]. */
async function takeAnchor(page: Page): Promise<{ x: number; y: number }> {
  let place = { x: 0, y: 0 };
  await converged(page);
  await expect(async () => {
    place = await anchorInSight(page);
    await page.mouse.move(place.x + 1, place.y);
    await page.mouse.move(place.x, place.y);
    await expect(page.locator(".hover-card")).toContainText("Anchor", { timeout: 2000 });
  }).toPass();
  await page.mouse.down();
  return place;
}

async function pull(page: Page, rounds: number, moves: number): Promise<Figures[]> {
  const found: Figures[] = [];
  for (let round = 0; round <= rounds; round++) {
    const from = await takeAnchor(page);
    await page.evaluate(() => (globalThis as never as { begin(): void }).begin());
    await wander(page, moves, (move) => ({
      x: from.x + 24 * Math.sin(move / 5),
      y: from.y + 16 * Math.cos(move / 7),
    }));
    const measured = await figures(page);
    await page.mouse.move(from.x, from.y);
    await page.mouse.up();
    // The first round warms up.
    if (round > 0) found.push(measured);
  }
  return found;
}

/** Draws a lasso round the whole net; returns the time from the button's event until the page has drawn the cells [ms]. */
async function lasso(page: Page): Promise<number> {
  const { x, y, width, height } = (await page.locator("main.viewport canvas").boundingBox())!;
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("Shift+L");
  await page.mouse.move(x + 60, y + 60);
  await page.mouse.down();
  for (const [
    across,
    down,
  ] of [[width - 60, 60], [width - 60, height - 60], [60, height - 60], [60, 80]]) // biome-ignore format: corners
    await page.mouse.move(x + across, y + down, { steps: 10 });
  await page.waitForTimeout(300);
  const took = page.evaluate(
    () =>
      new Promise<number>((done) => {
        const drawn = (event: Event) =>
          requestAnimationFrame(() => setTimeout(() => done(performance.now() - event.timeStamp)));
        addEventListener("pointerup", drawn, { once: true });
      }),
  );
  await page.waitForTimeout(50);
  await page.mouse.up();
  const time = await took;
  await expect(page.locator(".section h2").first()).toHaveText(/^[\d,]+ cells$/);
  await page.keyboard.press("Escape");
  return time;
}

test("figures of a window", async ({ page, open }) => {
  test.setTimeout(600_000);
  await page.addInitScript(watch);
  await open(wanted.pulled);
  const pulled = await pull(page, wanted.rounds, wanted.moves);
  await open(wanted.large);
  const large = await pull(page, wanted.rounds, wanted.moves);

  const hovers: number[][] = [];
  const box = (await page.locator("main.viewport canvas").boundingBox())!;
  for (let round = 0; round < wanted.rounds; round++) {
    await page.evaluate(() => (globalThis as never as { begin(): void }).begin());
    await wander(page, wanted.moves, (move) => ({
      x: box.x + 100 + ((37 * (move + round)) % (box.width - 200)),
      y: box.y + 100 + ((53 * (move + round)) % (box.height - 250)),
    }));
    hovers.push((await figures(page)).hovers);
  }

  const lassos: number[] = [];
  // The first round warms up.
  for (let round = 0; round <= wanted.rounds; round++) {
    const time = await lasso(page);
    if (round > 0) lassos.push(time);
  }

  await open(wanted.run);
  await page.getByRole("tab", { name: "Evolve" }).click();
  await page.getByRole("button", { name: "Pictures" }).click();
  await expect(page.locator(".gallery-cell").first()).toBeVisible();
  await page.locator(".gallery canvas").first().waitFor();
  const individuals = /[\d,]+/.exec(
    (await page.locator(".gallery header span").first().textContent())!,
  )![0];
  const gallery = await page.locator(".gallery-box").evaluate(async (scrolled, steps) => {
    const tasks: number[] = [];
    const observer = new PerformanceObserver((list) => {
      for (const entry of list.getEntries()) tasks.push(entry.duration);
    });
    observer.observe({ type: "longtask" });
    let elements = 0;
    const began = performance.now();
    for (let step = 0; step < steps; step++) {
      scrolled.scrollTo(step * 900, (step * 37) % 1800);
      await new Promise((next) => requestAnimationFrame(next));
      elements = Math.max(elements, document.querySelectorAll(".gallery *").length);
    }
    const seconds = (performance.now() - began) / 1000;
    for (const entry of observer.takeRecords()) tasks.push(entry.duration);
    // Chromium calls a task long from 50 ms on.
    return { elements, longest: Math.max(0, ...tasks), frames: steps / seconds };
  }, wanted.moves);
  const chromium = page.context().browser()!.version();
  const all = { chromium, pulled, large, hovers, lassos, gallery: { individuals, ...gallery } };
  writeFileSync(wanted.out, JSON.stringify(all));
});
