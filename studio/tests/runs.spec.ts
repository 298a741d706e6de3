// Runs that are driven elsewhere, survive a kill, and are chosen from: stories three to five.
import { type ChildProcess, execFileSync, spawn } from "node:child_process";
import { existsSync, readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "@playwright/test";
import { converged, documentOf, expect, revisit, startStudio, test } from "./studio";

const BIN = join(import.meta.dirname, "../../.venv/bin");

function evolving(folder: string, ...words: string[]): ChildProcess {
  return spawn(join(BIN, "springform"), ["evolve", ...words, "--out", folder], { stdio: "ignore" });
}

function digest(folder: string): string {
  const code = "import sys, springform; print(springform.open_run(sys.argv[1]).digest())";
  return execFileSync(join(BIN, "python"), ["-c", code, folder]).toString().trim();
}

/** Numbers of all individuals in a run's files of measures. */
function numbers(folder: string): string[] {
  const code = `import sys, springform; t = springform.open_run(sys.argv[1]).table
print(*(f"{g}/{i}" for g, i in zip(t["generation"], t["individual"])))`;
  return execFileSync(join(BIN, "python"), ["-c", code, folder]).toString().trim().split(" ");
}

async function generations(page: Page): Promise<number> {
  const fact = page.locator(".panel-evolve .fact", { hasText: /^Generations\d/ });
  return Number((await fact.locator(".fact-value").textContent())!.replace(",", ""));
}

test("a researcher watches a run of the command line and changes its course", async ({
  page,
  open,
  home,
}) => {
  const folder = join(home, "run-a");
  const driver = evolving(
    folder,
    ...["three-cylinders", "--population", "12", "--insertions", "1", "--threads", "1"],
    ...["--generations", "100000", "--max-springs", "900"],
  );
  try {
    await expect.poll(() => existsSync(join(folder, "journal.jsonl"))).toBe(true);
    await open(folder);
    await page.getByRole("tab", { name: "Evolve" }).click();
    await expect(page.locator(".panel-evolve")).toContainText("Driven by the command line");
    await expect.poll(() => generations(page)).toBeGreaterThan(20);
    await page.getByRole("button", { name: "Pause", exact: true }).first().click();
    await expect(page.getByRole("button", { name: "Continue" })).toBeVisible();
    const paused = await generations(page);
    await page.getByText("Parameters of runs").click();
    await page.getByLabel("Cells subdivided").fill("5%");
    await page.getByRole("button", { name: "Change from now on" }).click();
    await expect
      .poll(() => readFileSync(join(folder, "journal.jsonl"), "utf8"))
      .toContain('"insertions":"5%"');
    await page.getByRole("button", { name: "Continue" }).click();
    await expect.poll(() => generations(page)).toBeGreaterThan(paused + 3);
    await page.getByRole("button", { name: "Stop", exact: true }).click();
    await expect(page.locator(".panel-evolve")).not.toContainText("Driven by");
    const made = await generations(page);
    const lines = readFileSync(join(folder, "journal.jsonl"), "utf8").trim().split("\n");
    const numbered = lines.map((line) => JSON.parse(line)).filter((line) => "springs" in line);
    expect(numbered.map(({ generation }) => generation)).toEqual(
      Array.from({ length: made }, (_, at) => at + 1),
    );
    await page.getByRole("button", { name: "Pictures" }).click();
    const total = (made * 12).toLocaleString("en");
    await expect(page.locator(".gallery header")).toContainText(
      `${total} in ${made.toLocaleString("en")} generations`,
    );
  } finally {
    driver.kill("SIGKILL");
  }
});

test("a kill in mid-generation changes no bit of the run", async ({ page, open, home }) => {
  const studio = await open("three-cylinders");
  await page.getByRole("tab", { name: "Evolve" }).click();
  const fill = async (label: string, value: string) => {
    await page.getByLabel(label, { exact: true }).fill(value);
    await page.getByLabel(label, { exact: true }).blur();
  };
  await fill("Mutants a generation", "60");
  await fill("Cells subdivided", "1");
  await fill("End at springs (0: never)", "0");
  await fill("End at generation", "90");
  await page.getByRole("button", { name: "Evolve", exact: true }).click();
  await expect.poll(() => generations(page)).toBeGreaterThan(15);
  const { port, hash } = new URL(page.url());
  await studio.kill();
  const folder = join(home, hash.slice(1), "runs", "0001");
  expect(readdirSync(folder)).toContain("lock");

  const again = await startStudio(home, undefined, Number(port));
  await revisit(page, again, hash);
  // The panel that was in front is in front again.
  await expect(page.locator(".panel-evolve")).toContainText("paused: nobody drives it");
  await page.getByRole("button", { name: "Continue" }).click();
  await expect(page.locator(".panel-evolve")).toContainText("ended");
  expect(await generations(page)).toBe(90);
  await again.kill();

  const control = join(home, "control");
  const words = ["evolve", join(folder, "design.toml"), "--out", control, "--population", "60"];
  const same = ["--insertions", "1", "--generations", "90", "--types", "1,6"];
  execFileSync(join(BIN, "springform"), [...words, ...same], { stdio: "ignore" });
  expect(digest(folder)).toBe(digest(control));
  const all = numbers(folder);
  expect(new Set(all).size).toBe(all.length);
  expect(all.length).toBe(90 * 60);
});

test("a tutor brushes, groups and takes a representative over", async ({ page, open, home }) => {
  const folder = join(home, "run-b");
  const words = ["three-cylinders", "--population", "40", "--generations", "25", "--out", folder];
  execFileSync(join(BIN, "springform"), ["evolve", ...words], { stdio: "ignore" });
  await open(folder);
  await page.getByRole("tab", { name: "Evolve" }).click();
  await page.getByLabel("Springs, at least").fill("1000");
  await page.getByLabel("Springs, at least").blur();
  await page.getByLabel("Differential, at most").fill("20");
  await page.getByLabel("Differential, at most").blur();
  const told = page.locator(".panel-evolve").getByText(/^[\d,]+ of 1,000 individuals/);
  const words2 = (await told.textContent())!;
  const brushed = Number(words2.split(" ")[0].replace(",", ""));
  expect(brushed).toBeGreaterThan(0);
  expect(brushed).toBeLessThan(1000);
  await page.getByRole("button", { name: "Pictures" }).click();
  await expect(page.locator(".gallery header")).toContainText(`${brushed} in`);
  for (const cell of await page.locator(".gallery .gallery-cell").all()) {
    const [, springs, differential] = (await cell.getAttribute("aria-label"))!.match(
      /: ([\d,]+) springs, force differential ([\d.]+)/,
    )!;
    expect(Number(springs.replace(",", ""))).toBeGreaterThanOrEqual(1000);
    expect(Number(differential)).toBeLessThanOrEqual(20);
  }
  const row = page.locator(".gallery-row").first().locator("small b");
  const shownOrder = (await row.allTextContents()).map(Number);
  expect(shownOrder).toEqual([...shownOrder].sort((a, b) => a - b));
  await page.getByLabel("Groups", { exact: true }).fill("5");
  await page.getByLabel("Groups", { exact: true }).blur();
  await page.getByRole("button", { name: "Group", exact: true }).click();
  const representative = page.getByRole("button", { name: /^Representative 3 of/ });
  await representative.click();
  await expect(page.locator(".looking")).toContainText("individual");
  const shown = await documentOf(page);
  await expect(page.locator(".lineage li").first()).toBeVisible();
  await page.locator(".lineage li button").first().click();
  await page.getByRole("button", { name: "Take over as my design" }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  await converged(page);
  const taken = await documentOf(page);
  expect(taken.history[0].label).toMatch(/^Take over generation \d+, individual \d+$/);
  expect(taken.figures).toEqual(shown.figures);
});

test("scrolling through many individuals blocks nothing for long", async ({ page, open, home }) => {
  const folder = join(home, "run-c");
  const words = ["canopy", "--population", "2500", "--generations", "20", "--insertions", "1"];
  execFileSync(join(BIN, "springform"), ["evolve", ...words, "--out", folder], { stdio: "ignore" });
  await open(folder);
  await page.getByRole("tab", { name: "Evolve" }).click();
  await page.getByRole("button", { name: "Pictures" }).click();
  await expect(page.locator(".gallery header")).toContainText("50,000 in 20 generations");
  await expect(page.locator(".gallery-cell").first()).toBeVisible();
  const measured = await page.locator(".gallery-box").evaluate(async (box) => {
    const tasks: number[] = [];
    const observer = new PerformanceObserver((list) => {
      for (const entry of list.getEntries()) tasks.push(entry.duration);
    });
    observer.observe({ type: "longtask" });
    let most = 0;
    for (let step = 0; step < 60; step++) {
      box.scrollTo(step * 900, (step * 37) % 1800);
      await new Promise((next) => requestAnimationFrame(next));
      most = Math.max(most, box.querySelectorAll("*").length);
    }
    observer.disconnect();
    return { longest: Math.max(0, ...tasks), most };
  });
  console.log(`longest task while scrolling: ${measured.longest.toFixed(0)} ms`);
  expect(measured.most).toBeLessThan(500);
});
