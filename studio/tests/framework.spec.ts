// The framework by form: every kind of edit, each followed by the net, or refused with the reason.
import type { Page } from "@playwright/test";
import { pictureOf } from "./picture";
import { converged, documentOf, expect, still, test, undoTo } from "./studio";

interface Framework {
  grid: string;
  cylinders: { name: string; around: number; along: number }[];
  sheets: unknown[];
  joins: { reversed: boolean; cord: boolean; first: { length: number } }[];
}

const framework = async (page: Page) => (await documentOf(page)).framework as unknown as Framework;

async function type(page: Page, label: string, value: string, at = 0): Promise<void> {
  const field = page.getByLabel(label, { exact: true }).nth(at);
  await field.fill(value);
  await field.press("Enter");
}

/** Applies what was filled in; returns the document after the action, with the net at rest. */
async function applied(page: Page) {
  const { position } = await documentOf(page);
  await page.getByRole("button", { name: "Apply", exact: true }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(position + 1);
  await converged(page);
  const state = await documentOf(page);
  // The page has the net that the engine has.
  await expect(page.locator(".status-fact").last()).toContainText(
    `${state.figures.springs.toLocaleString("en")} springs`,
  );
  return state;
}

async function refused(page: Page, reason: string | RegExp): Promise<void> {
  const before = await documentOf(page);
  await page.getByRole("button", { name: "Apply", exact: true }).click();
  await expect(page.locator(".apply .problem")).toContainText(reason);
  await expect(page.locator("[data-sonner-toast]").last()).toContainText(reason);
  expect(await documentOf(page)).toEqual(before);
  await page.getByRole("button", { name: "As it was" }).click();
  await expect(page.getByRole("button", { name: "Apply", exact: true })).toBeDisabled();
}

test("counts, grid and names change the net", async ({ page, visit }) => {
  await visit("one-cylinder");
  await page.getByRole("tab", { name: "Framework" }).click();
  await still(page);
  const drawn = await pictureOf(page);
  const bare = (await documentOf(page)).figures;

  await type(page, "around", "24");
  await type(page, "along", "10");
  let state = await applied(page);
  // A dia-grid has a cell a diamond, and half ones at the free rings.
  expect((await framework(page)).cylinders[0]).toMatchObject({ around: 24, along: 10 });
  expect(state.figures.cells).toBeGreaterThan(bare.cells);
  await still(page);
  expect((await pictureOf(page)).hash).not.toBe(drawn.hash);

  await page.getByLabel("Cells lie").selectOption("quad");
  state = await applied(page);
  expect((await framework(page)).grid).toBe("quad");
  expect(state.figures.cells).toBe(24 * 10);

  await page.getByLabel("Name of cylinder 1").fill("chimney");
  await refused(page, /tube/);
  await type(page, "around", "4");
  await refused(page, "framework.anchors");
});

test("cylinders, sheets and joins are added and removed", async ({ page, visit }) => {
  await visit("three-cylinders-quad");
  await page.getByRole("tab", { name: "Framework" }).click();
  const before = await documentOf(page);

  // A cord along a seam is a spring more an edge.
  await page.getByRole("group", { name: "Join 1" }).getByLabel("cord along it").check();
  await applied(page);
  expect((await framework(page)).joins[0].cord).toBe(true);

  // A join that is undone leaves free edges where cells met.
  const { figures, framework: kept } = await documentOf(page);
  await page
    .getByRole("button", { name: /^Remove join/ })
    .last()
    .click();
  const apart = await applied(page);
  expect((await framework(page)).joins).toHaveLength(
    (kept as unknown as Framework).joins.length - 1,
  );
  expect(apart.figures.nodes).toBeGreaterThan(figures.nodes);

  // What nothing holds carries no force, and so has no springs; it is there to be joined.
  await page.getByRole("button", { name: "Add a sheet" }).click();
  await page.getByRole("button", { name: "Add a cylinder" }).click();
  const more = await applied(page);
  expect(more.figures.springs).toBe(apart.figures.springs);
  expect((await framework(page)).sheets).toHaveLength(1);
  expect((await framework(page)).cylinders.map(({ name }) => name)).toContain("cylinder_4");
  await page.getByRole("button", { name: "Remove sheet_1" }).click();
  await page.getByRole("button", { name: "Remove cylinder_4" }).click();
  await applied(page);
  await page.getByRole("group", { name: "Join 1" }).getByLabel("edges").first().fill("3");
  await page.getByRole("group", { name: "Join 1" }).getByLabel("edges").first().press("Enter");
  await refused(page, "framework.joins");

  await undoTo(page, 0);
  await expect.poll(async () => (await documentOf(page)).figures).toEqual(before.figures);
  expect((await documentOf(page)).framework).toEqual(before.framework);
});
