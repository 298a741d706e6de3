// What takes longer than a moment says so, in one place, whatever it is.
import { execFileSync } from "node:child_process";
import { join } from "node:path";
import type { Page } from "@playwright/test";
import { accessible, converged, expect, test } from "./studio";

const BIN = join(import.meta.dirname, "../../.venv/bin");

/** Has the engine's answers come late from now on; returns what makes them come at once again. */
async function slowed(page: Page): Promise<(late: boolean) => void> {
  let wait = 0;
  const later = () => new Promise((done) => setTimeout(done, wait));
  await page.route("**/api/**", async (route) => {
    await later();
    await route.continue().catch(() => {});
  });
  await page.routeWebSocket(/\/socket/, (socket) => {
    const engine = socket.connectToServer();
    engine.onMessage(async (message) => {
      if (typeof message === "string" && message.includes('"type":"reply"')) await later();
      socket.send(message);
    });
  });
  return (late) => {
    wait = late ? 900 : 0;
  };
}

test("whatever is waited for is told, and only while it is", async ({ page, open, home }) => {
  const late = await slowed(page);
  const busy = page.locator(".busy").last();
  // What comes after it may be told instead a moment later.
  await page.addInitScript(() => {
    const said: string[] = [];
    Object.assign(window, { said });
    new MutationObserver(() => {
      for (const one of document.querySelectorAll(".busy")) said.push(one.textContent ?? "");
    }).observe(document, { childList: true, characterData: true, subtree: true });
  });
  const said = () => page.evaluate(() => (window as unknown as { said: string[] }).said.join("\n"));
  const told = async (words: string, act: () => Promise<unknown>) => {
    await expect(busy).toHaveText("");
    await page.evaluate(() => (window as unknown as { said: string[] }).said.splice(0));
    late(true);
    await act();
    await expect.poll(said).toContain(words);
    late(false);
    await expect(busy).toHaveText("");
  };
  const folder = join(home, "run");
  const words = ["one-cylinder", "--population", "8", "--generations", "4", "--out", folder];
  execFileSync(join(BIN, "springform"), ["evolve", ...words], { stdio: "ignore" });

  await open();
  await page.locator(".scenes button").first().waitFor();
  await told("Reading the folder", () =>
    page.getByRole("button", { name: "The folder above" }).click(),
  );
  await told("Looking for documents", () => page.reload({ waitUntil: "commit" }));
  await page.locator(".scenes button").first().waitFor();
  await page.getByRole("textbox").fill(folder);
  await told("Opening", () => page.getByRole("button", { name: "Open", exact: true }).click());
  await converged(page);

  const finer = page.getByRole("button", { name: "Finer: whole net" });
  await told("Working out what it would do", () => finer.hover());
  await told("Changing the density", () => finer.click());
  await converged(page);
  await told("Undoing", () => page.keyboard.press("Control+z"));
  await told("Writing the file", async () => {
    await page.getByRole("button", { name: /^Document/ }).click();
    await page.getByRole("menuitem", { name: /JSON/ }).click();
  });
  await page.keyboard.press("Control+Shift+s");
  await page.getByLabel("Path on this machine").fill(join(home, "net.toml"));
  await told("Saving", () => page.getByRole("button", { name: "Save", exact: true }).click());
  await expect(page.getByRole("dialog")).toBeHidden();

  await page.getByRole("tab", { name: "Evolve" }).click();
  await told("Grouping", () => page.getByRole("button", { name: "Group", exact: true }).click());
  await told("Rebuilding nets", () => page.getByRole("button", { name: "Pictures" }).click());
  const cells = page.locator(".gallery .gallery-cell");
  await told("Rebuilding the net", () => cells.nth(2).click());
  await told("Comparing", () => page.keyboard.press("Shift+P"));
  await accessible(page);
  await page.keyboard.press("Escape");
  await told("Taking it over", () =>
    page.getByRole("button", { name: "Take over as my design" }).click(),
  );
});
