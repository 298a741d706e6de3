// What every test starts from: a studio of its own, with documents in a folder of its own.
import { type ChildProcess, spawn } from "node:child_process";
import { mkdirSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import AxeBuilder from "@axe-core/playwright";
import { test as base, expect, type Page } from "@playwright/test";
import type { DocumentState, Opened, Opening } from "../src/protocol/messages";

export { expect };

/** The folder in which studios are started: that of the tests is nothing to show in pictures. */
export const NETS = join(tmpdir(), "springform-nets");
mkdirSync(NETS, { recursive: true });

/** A running studio. */
export interface Studio {
  /** With the token; with the document if one was asked for. */
  address: string;
  home: string;
  process: ChildProcess;
  /** Stops it at once, as a power cut would. */
  kill(): Promise<void>;
}

/** Starts a studio on a source, in a folder of documents; without a port (null) on that of last time. */
export async function startStudio(
  home: string,
  source?: string,
  port: number | null = 0,
): Promise<Studio> {
  const words = [
    "studio",
    ...(source ? [source] : []),
    "--home",
    home,
    ...(port === null ? [] : ["--port", String(port)]),
    "--no-browser",
    "--json",
  ];
  const PATH = `${join(import.meta.dirname, "../../.venv/bin")}:${process.env.PATH}`;
  const child = spawn("springform", words, {
    env: { ...process.env, PATH },
    cwd: NETS,
    stdio: ["ignore", "pipe", "inherit"],
  });
  const ended = new Promise<void>((resolve) => child.once("exit", () => resolve()));
  const line = await new Promise<string>((resolve, reject) => {
    createInterface(child.stdout!).once("line", resolve);
    child.once("exit", (code) => reject(new Error(`the studio ended with ${code}`)));
  });
  return {
    address: (JSON.parse(line) as { address: string }).address,
    home,
    process: child,
    kill: async () => {
      child.kill("SIGKILL");
      await ended;
    },
  };
}

/** Opens a document of a studio that was started again; its address may be what it was. */
export async function revisit(page: Page, studio: Studio, hash: string): Promise<void> {
  await page.goto(`${studio.address}${hash}`);
  // Going to the address that a page has leaves the page as it is, and it may not yet be connected.
  await page.reload();
}

/** Id of the document that a page shows. */
export function documentId(page: Page): string {
  return new URL(page.url()).hash.slice(1).split("?")[0];
}

/** The document as the engine holds it. */
export async function documentOf(page: Page): Promise<DocumentState> {
  const { origin, search } = new URL(page.url());
  const response = await page.request.get(`${origin}/api/documents/${documentId(page)}${search}`);
  expect(response.status()).toBe(200);
  return (await response.json()) as DocumentState;
}

/** Waits until the net that the engine holds is shown and has come to rest at equilibrium. */
export async function converged(page: Page): Promise<void> {
  await expect
    .poll(async () => {
      const shown = await page.locator("main.viewport canvas").getAttribute("data-revision");
      return Number(shown) - (await documentOf(page)).revision;
    })
    .toBe(0);
  await expect(page.locator(".badge")).toHaveText("converged");
}

/** Nothing on the page is a serious finding of axe. */
export async function accessible(page: Page): Promise<void> {
  const { violations } = await new AxeBuilder({ page }).analyze();
  const serious = violations.filter(({ impact }) => impact === "serious" || impact === "critical");
  expect(
    serious.map(({ id, nodes }) => `${id}: ${nodes.map(({ target }) => target).join(", ")}`),
  ).toEqual([]);
}

/** Where an anchor is on the page [px]. */
export async function anchorPlace(page: Page, name: string): Promise<{ x: number; y: number }> {
  const label = page.locator(".anchor-names span", { hasText: new RegExp(`^${name}$`) });
  // The label stands 9 px right of the anchor and 20 px above it.
  const box = (await label.evaluate((element) => {
    const { left, top } = element.getBoundingClientRect();
    return { left, top };
  })) as { left: number; top: number };
  return { x: box.left - 9, y: box.top + 20 };
}

/** Waits until the page has drawn what it knows, as finely as it does. */
export async function still(page: Page): Promise<void> {
  await nextPicture(page);
  await expect(page.locator("main.viewport canvas")).toHaveAttribute("data-fine", "true");
  await nextPicture(page);
}

/** Waits for the picture after the next one. */
export async function nextPicture(page: Page): Promise<void> {
  await page.evaluate(
    () => new Promise((next) => requestAnimationFrame(() => requestAnimationFrame(next))),
  );
}

/** Undoes until so many actions are done. */
export async function undoTo(page: Page, position: number): Promise<void> {
  await page.locator("main.viewport canvas").focus();
  for (let now = (await documentOf(page)).position; now > position; now--) {
    await page.keyboard.press("Control+z");
    await expect.poll(async () => (await documentOf(page)).position).toBe(now - 1);
  }
}

/** Moves the pointer up from a place until it is on a cell; returns where that is [px]. */
export async function cellAbove(
  page: Page,
  place: { x: number; y: number },
): Promise<{ x: number; y: number }> {
  const card = page.locator(".hover-card");
  for (let up = 45; up < 200; up += 7) {
    await page.mouse.move(place.x, place.y - up);
    await nextPicture(page);
    if ((await card.count()) && (await card.textContent())?.startsWith("Cell"))
      return { x: place.x, y: place.y - up };
  }
  throw new Error("there is no cell above");
}

/** Moves the pointer up from a place until it is on a cell, and clicks it. */
export async function clickCellAbove(page: Page, place: { x: number; y: number }): Promise<void> {
  await cellAbove(page, place);
  await page.mouse.down();
  await page.mouse.up();
}

interface Fixtures {
  /** A folder of its own for a studio's documents. */
  home: string;
  /** Opens a window of a studio of its own. */
  open: (source?: string) => Promise<Studio>;
  /** Opens a window with a new document, in the studio that tests share. */
  visit: (source: string) => Promise<void>;
}

export const test = base.extend<Fixtures, { shared: Studio }>({
  shared: [
    // biome-ignore lint/correctness/noEmptyPattern: Playwright reads what a fixture needs from the pattern
    async ({}, use) => {
      const home = mkdtempSync(join(tmpdir(), "springform-studio-"));
      const studio = await startStudio(home);
      await use(studio);
      await studio.kill();
      rmSync(home, { recursive: true });
    },
    { scope: "worker" },
  ],
  visit: async ({ page, shared }, use) => {
    page.on("pageerror", (error) => {
      throw error;
    });
    await use(async (source) => {
      const { origin, search } = new URL(shared.address);
      const data = { source } satisfies Opening;
      const response = await page.request.post(`${origin}/api/documents${search}`, { data });
      const { id } = (await response.json()) as Opened;
      await page.goto(`${origin}/${search}#${id}`);
      await converged(page);
    });
  },
  // biome-ignore lint/correctness/noEmptyPattern: Playwright reads what a fixture needs from the pattern
  home: async ({}, use) => {
    const home = mkdtempSync(join(tmpdir(), "springform-studio-"));
    await use(home);
    rmSync(home, { recursive: true });
  },
  open: async ({ home, page }, use) => {
    const started: Studio[] = [];
    page.on("pageerror", (error) => {
      throw error;
    });
    await use(async (source) => {
      const studio = await startStudio(home, source);
      started.push(studio);
      await page.goto(studio.address);
      if (source) await converged(page);
      return studio;
    });
    for (const studio of started) await studio.kill();
  },
});
