// What every test starts from: a studio of its own, with documents in a folder of its own.
import { type ChildProcess, spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import AxeBuilder from "@axe-core/playwright";
import { test as base, expect, type Page } from "@playwright/test";
import type { DocumentState } from "../src/protocol/messages";

export { expect };

/** A running studio. */
export interface Studio {
  /** With the token; with the document if one was asked for. */
  address: string;
  home: string;
  process: ChildProcess;
  /** Stops it at once, as a power cut would. */
  kill(): Promise<void>;
}

/** Starts a studio on a source, in a folder of documents. */
export async function startStudio(home: string, source?: string, port = 0): Promise<Studio> {
  const words = [
    "studio",
    ...(source ? [source] : []),
    "--home",
    home,
    "--port",
    String(port),
    "--no-browser",
    "--json",
  ];
  const PATH = `${join(import.meta.dirname, "../../.venv/bin")}:${process.env.PATH}`;
  const child = spawn("springform", words, {
    env: { ...process.env, PATH },
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

/** The document as the engine holds it. */
export async function documentOf(page: Page): Promise<DocumentState> {
  const { hash, origin, search } = new URL(page.url());
  const response = await page.request.get(`${origin}/api/documents/${hash.slice(1)}${search}`);
  expect(response.status()).toBe(200);
  return (await response.json()) as DocumentState;
}

/** Waits until the net has come to rest at equilibrium. */
export async function converged(page: Page): Promise<void> {
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

/** Moves the pointer up from a place until it is on a cell, and clicks it. */
export async function clickCellAbove(page: Page, place: { x: number; y: number }): Promise<void> {
  const card = page.locator(".hover-card");
  for (let up = 45; up < 200; up += 7) {
    await page.mouse.move(place.x, place.y - up);
    await page.waitForTimeout(100);
    if ((await card.count()) && (await card.textContent())?.startsWith("Cell")) break;
  }
  await page.mouse.down();
  await page.mouse.up();
}

export const test = base.extend<{ home: string; open: (source?: string) => Promise<Studio> }>({
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
