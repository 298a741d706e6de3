// The start page: folders, names of files, documents ahead of their file, removal; and a studio that comes back.
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { converged, documentOf, expect, startStudio, test } from "./studio";

test("a net is named after its file, and goes back to it", async ({ page, open, home }) => {
  await open("sheet");
  await page.keyboard.press("Control+Shift+s");
  const path = page.getByLabel("Path on this machine");
  await path.fill(join(home, "first net"));
  await path.press("Enter");
  await expect(page.getByRole("button", { name: "Document first net" })).toBeVisible();
  const saved = await documentOf(page);
  expect(saved.file).toBe(join(home, "first net.toml"));
  expect(saved.saved).toBe(true);
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("g");
  await expect(async () => expect((await documentOf(page)).saved).toBe(false)).toPass();

  await page.keyboard.press("Control+o");
  await expect(page.locator(".recent b")).toHaveText(["first net"]);
  const source = page.getByPlaceholder(/Path of a design/);
  await source.fill(join(home, "no such net.toml"));
  await source.press("Enter");
  await expect(page.getByRole("alert")).toBeInViewport();
  await source.fill(saved.file!);
  await source.press("Enter");
  await page.getByRole("button", { name: "Back to the file" }).click();
  await expect(async () => {
    const back = await documentOf(page);
    expect(back.saved).toBe(true);
    expect(back.figures.springs).toBe(saved.figures.springs);
  }).toPass();
  await page.keyboard.press("Control+z");
  await expect(async () => expect((await documentOf(page)).saved).toBe(false)).toPass();
});

test("folders are entered, and documents removed for good", async ({ page, open, home }) => {
  await open("sheet");
  const file = join(home, "kept.toml");
  await page.keyboard.press("Control+Shift+s");
  await page.getByLabel("Path on this machine").fill(file);
  await page.getByLabel("Path on this machine").press("Enter");
  await expect(page.getByRole("button", { name: "Document kept" })).toBeVisible();
  writeFileSync(join(home, "notes.txt"), "no design");
  const { origin, search } = new URL(page.url());
  const ask = (path: string) =>
    page.request.get(`${origin}/api/folder${search}&path=${encodeURIComponent(path)}`);
  const names = ((await (await ask(home)).json()) as { entries: { name: string }[] }).entries.map(
    ({ name }) => name,
  );
  expect(names).toContain("kept.toml");
  expect(names).not.toContain("notes.txt");
  expect((await ask(file)).status()).toBe(422);

  await page.keyboard.press("Control+o");
  await page.getByRole("button", { name: "Remove kept", exact: true }).click();
  await page.getByRole("button", { name: "Remove kept for good" }).click();
  await expect(page.locator(".recent li")).toHaveCount(0);
  // The design file is the person's own.
  await page.getByPlaceholder(/Path of a design/).fill(file);
  await page.getByRole("button", { name: "Open", exact: true }).click();
  await converged(page);
  expect((await documentOf(page)).length).toBe(0);
});

test("a window left open finds the studio again after a restart", async ({ page, open, home }) => {
  const first = await open("sheet");
  await first.kill();
  await expect(page.locator(".line-state")).toContainText("does not answer");
  const second = await startStudio(home, undefined, null);
  try {
    expect(second.address).toBe(first.address.split("#")[0]);
    await expect(page.locator(".line-state")).toHaveCount(0, { timeout: 15_000 });
    await converged(page);
    const wrong = await page.request.get(`${new URL(page.url()).origin}/?token=none`, {
      headers: { accept: "text/html" },
    });
    expect(wrong.status()).toBe(403);
    expect(await wrong.text()).toContain("springform studio");
  } finally {
    await second.kill();
  }
});

test("the spring that carries most is found by name", async ({ page, visit }) => {
  await visit("three-cylinders");
  const { figures } = await documentOf(page);
  await page.getByRole("button", { name: "Largest force" }).click();
  const selected = page.locator(".section").first();
  await expect(selected).toContainText(figures.force_max.toPrecision(4));
});
