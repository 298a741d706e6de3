// Editing while the net moves: laws, supports, density, filters; sections.
import * as THREE from "three";
import type { Motion } from "../src/document/motion";
import type { Net } from "../src/document/net";
import type { Section } from "../src/document/section";
import { Projection, pick } from "../src/viewport/picking";
import { MIDDLING, pictureOf, STRONGEST } from "./picture";
import { anchorPlace, converged, documentOf, expect, nextPicture, still, test } from "./studio";

test("the law of a cylinder is changed while the net moves, and taken back", async ({
  page,
  visit,
}) => {
  await visit("three-cylinders");
  const before = await documentOf(page);
  await page.getByRole("combobox", { name: "Of", exact: true }).selectOption("part trunk");
  await page.getByRole("combobox", { name: "Law", exact: true }).selectOption("axial_stiffness");
  await expect(page.locator(".formula")).toContainText("EA refers to the unstressed length L0");
  await page.getByRole("textbox", { name: /^Axial stiffness EA/ }).fill("3");
  await page.getByRole("button", { name: "Put the net back to where it was drawn" }).click();
  await page.getByRole("button", { name: "Apply to trunk" }).click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  const after = await documentOf(page);
  expect(after.spring_groups).toEqual([
    { title: "trunk", says: "EA = 3 N · L0 = 0.8 × drawn · tension" },
  ]);
  expect(after.figures.force_max).not.toBeCloseTo(before.figures.force_max, 3);
  await converged(page);
  await expect(page.getByTestId("legend-high")).toContainText(
    after.figures.force_max.toPrecision(3).replace(/\.?0+$/, ""),
  );
  await page.getByRole("button", { name: "Take back: trunk" }).click();
  await expect.poll(async () => (await documentOf(page)).spring_groups).toEqual([]);
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("Control+z");
  await page.keyboard.press("Control+z");
  await expect.poll(async () => (await documentOf(page)).position).toBe(0);
  expect((await documentOf(page)).figures).toEqual(before.figures);
});

test("every law can be given, and what is refused is said", async ({ page, visit }) => {
  await visit("one-cylinder");
  const laws: [key: string, says: RegExp][] = [
    ["axial_stiffness", /^EA = .* N · L0 = 0\.8 × drawn · tension$/],
    ["force_density", /^q = .* N\/m · tension$/],
    ["force", /^T = .* N · tension$/],
    ["curve", /^a measured curve · L0 = 0\.8 × drawn · tension$/],
    ["stiffness", /^k = .* N\/m/],
  ];
  for (const [at, [key, says]] of laws.entries()) {
    await page.getByRole("combobox", { name: "Law", exact: true }).selectOption(key);
    await page.getByRole("button", { name: "Apply to all springs" }).click();
    await expect.poll(async () => (await documentOf(page)).position).toBe(at + 1);
    expect((await documentOf(page)).spring_groups.at(-1)?.says).toMatch(says);
  }
  await page.getByRole("textbox", { name: /^Stiffness k(?!,)/ }).fill("-1");
  await page.getByRole("button", { name: "Apply to all springs" }).click();
  await expect(page.locator("[data-sonner-toast]")).toContainText(
    "Stiffness: must be greater than 0, not -1",
  );
  expect((await documentOf(page)).position).toBe(laws.length);
});

test("colours follow forces, not shapes", async ({ page, visit }) => {
  await visit("three-cylinders");
  await page.getByRole("button", { name: "Scale and palette" }).click();
  await page.getByLabel("Range").selectOption("fixed");
  await page.keyboard.press("Escape");
  await still(page);
  const before = await pictureOf(page);
  const positions = (await documentOf(page)).figures;
  const stiffness = page.getByLabel("Stiffness k, F = k L");
  await stiffness.fill("2");
  await stiffness.press("Enter");
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  await converged(page);
  await still(page);
  const doubled = (await documentOf(page)).figures;
  expect(doubled.force_max).toBeCloseTo(2 * positions.force_max, 6);
  expect(doubled.total_length).toBeCloseTo(positions.total_length, 6);
  const after = await pictureOf(page);
  expect(after.share(STRONGEST, 60)).toBeGreaterThan(3 * before.share(STRONGEST, 60));
});

test("an anchor slides, and is dragged along an arm", async ({ page, visit }) => {
  await visit("three-cylinders");
  const anchorOf = async (name: string) =>
    (await documentOf(page)).anchors.find((anchor) => anchor.name === name)!;
  const before = await anchorOf("A7");
  const place = await anchorPlace(page, "A7");
  await page.mouse.click(place.x, place.y);
  await expect(page.getByRole("heading", { name: "Anchor A7" })).toBeVisible();
  await page.mouse.move(place.x, place.y - 40);
  await page.mouse.down();
  await page.mouse.move(place.x + 6, place.y - 90, { steps: 6 });
  await page.mouse.up();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  const moved = await anchorOf("A7");
  expect(moved.position.slice(0, 2)).toEqual(before.position.slice(0, 2));
  expect(moved.position[2]).toBeGreaterThan(before.position[2] + 0.1);

  await page.getByLabel("Support").selectOption("xy");
  await expect.poll(async () => (await anchorOf("A7")).holds).toBe("xy");
  await converged(page);
  await expect(page.locator(".fact", { hasText: "is now at" })).toBeVisible();
  await page.getByLabel("Support").selectOption("line");
  await page.getByRole("group", { name: "Direction of the line" }).getByLabel("x").fill("1");
  await page.getByRole("group", { name: "Direction of the line" }).getByLabel("x").press("Enter");
  await page.getByRole("button", { name: "Apply", exact: true }).click();
  await expect.poll(async () => (await anchorOf("A7")).line).toEqual([1, 0, 1]);
  await page.getByLabel("Support").selectOption("xyz");
  await expect.poll(async () => (await anchorOf("A7")).line).toBe(null);
  await page.getByLabel("Support").selectOption("free");
  await expect.poll(async () => (await documentOf(page)).anchors.length).toBe(11);
});

test("density and filters are looked at before they are applied", async ({ page, visit }) => {
  await visit("three-cylinders-quad");
  const before = await documentOf(page);
  const finer = page.getByRole("button", { name: "Finer: trunk" });
  await finer.hover();
  const card = page.locator(".preview-card");
  await expect(card).toContainText("+384 cells");
  const counts = (await card.textContent())!;
  const added = Number(/\+([\d,]+) springs/.exec(counts)![1].replace(",", ""));
  const removed = Number(/−([\d,]+) springs/.exec(counts)?.[1].replace(",", "") ?? 0);
  expect(await documentOf(page)).toEqual(before);
  await finer.click();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  const after = await documentOf(page);
  expect(after.figures.springs).toBe(before.figures.springs + added - removed);
  await expect(card).toBeHidden();

  const filters = page.getByLabel("Filter method");
  await filters.selectOption("recursive");
  await expect(card).toContainText("Recursive");
  expect((await documentOf(page)).method).toBe(after.method);
  await page.getByRole("button", { name: "Apply", exact: true }).click();
  await expect.poll(async () => (await documentOf(page)).method).toBe("recursive");
});

test("a section takes half of the net away, and the rest can be picked", async ({
  page,
  visit,
}) => {
  await visit("three-cylinders");
  await still(page);
  const whole = await pictureOf(page);
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("k");
  await page.getByRole("button", { name: "Section across x" }).click();
  await page.mouse.move(500, 760);
  await still(page);
  const half = await pictureOf(page);
  expect(half.lit).toBeLessThan(0.9 * whole.lit);
  await page.getByLabel("Place of the section").fill("1");
  await still(page);
  expect((await pictureOf(page)).lit).toBeGreaterThan(half.lit);
});

test("whatever a section shows of a spring can be picked", async ({ page, open }) => {
  await open("three-cylinders");
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("k");
  await page.getByRole("button", { name: "Section across x" }).click();
  await page.mouse.move(500, 760);
  await still(page);
  // Everything that is drawn answers, up to the very plane.
  const ground = await pictureOf(page);
  const card = page.locator(".hover-card");
  const springs = ground.nearest(MIDDLING);
  expect(springs.length).toBeGreaterThan(1000);
  for (let sample = 0; sample < 60; sample++) {
    const { x, y } = springs[Math.floor((sample / 60) * springs.length)];
    await page.mouse.move(x, y);
    await nextPicture(page);
    expect(await card.count(), `something lies at ${x}, ${y}`).toBe(1);
  }
});

test("of a spring across a section the visible part is found, and no more", () => {
  const positions = new Float32Array([-1, 0, 0, 1, 0, 0, -1, 0, 1, -0.2, 0, 1]);
  const camera = new THREE.PerspectiveCamera(40, 1.25, 0.1, 100);
  camera.position.set(0, -6, 0.5);
  camera.up.set(0, 0, 1);
  camera.lookAt(0, 0, 0.5);
  camera.updateMatrixWorld();
  const motion = { positions } as Motion;
  const net = { ends: new Int32Array([0, 1, 2, 3]) } as Net;
  const at = (x: number, z: number) => {
    const seen = new THREE.Vector3(x, 0, z).project(camera);
    return [(seen.x + 1) * 400, (1 - seen.y) * 320] as const;
  };
  const picked = (section: Section | null, x: number, z = 0) =>
    pick(net, new Projection({ motion, camera, width: 800, height: 640, section }), ...at(x, z), {
      springs: true,
    })?.row ?? null;
  expect([-0.9, -0.1, 0.1, 0.9].map((x) => picked(null, x))).toEqual([0, 0, 0, 0]);
  for (const share of [0.25, 0.5, 0.8]) {
    const plane = -1 + 2 * share;
    for (const flipped of [false, true]) {
      const section: Section = { axis: 0, share, flipped };
      for (const x of [-0.95, plane - 0.05, plane + 0.05, 0.95])
        expect(picked(section, x)).toBe(x < plane !== flipped ? 0 : null);
    }
  }
  expect(picked({ axis: 0, share: 0.5, flipped: false }, -0.6, 1)).toBe(1);
  expect(picked({ axis: 0, share: 0.5, flipped: true }, -0.6, 1)).toBe(null);
});

test("springs of about the same force are selected and given a law", async ({ page, visit }) => {
  await visit("three-cylinders");
  const anchor = await anchorPlace(page, "A4");
  await page.mouse.click(anchor.x - 9, anchor.y - 34);
  await page.getByRole("button", { name: "Same force", exact: true }).click();
  const heading = page.getByRole("heading", { name: /^\d+ springs$/ });
  await expect(heading).toBeVisible();
  const count = Number.parseInt((await heading.textContent())!, 10);
  expect(count).toBeGreaterThan(4);
  await page.getByRole("textbox", { name: /^Stiffness k(?!,)/ }).fill("1.5");
  await page.getByRole("button", { name: /^Apply to the/ }).click();
  await expect
    .poll(async () => (await documentOf(page)).spring_groups)
    .toEqual([{ title: `${count} springs`, says: "k = 1.5 N/m · both" }]);
});

test("types are given with a brush", async ({ page, visit }) => {
  await visit("three-cylinders-quad");
  const before = await documentOf(page);
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("Shift+B");
  await page.getByLabel("Type of the brush").selectOption("2");
  const { x, y } = await anchorPlace(page, "A4");
  await page.mouse.move(x, y - 60);
  await page.mouse.down();
  await page.mouse.move(x, y - 160, { steps: 12 });
  await page.mouse.up();
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  const { history, figures } = await documentOf(page);
  expect(history.at(-1)?.label).toMatch(/^Give .* type 2 braced$/);
  expect(figures.springs).not.toBe(before.figures.springs);
});

test("what the form shows of springs is what counts", async ({ page, visit }) => {
  await visit("sheet");
  const sense = page.getByLabel("Sense");
  const constant = page.getByRole("textbox", { name: /^Stiffness k(?!,)/ });
  const before = await sense.inputValue();
  await constant.fill("3");
  await page.getByRole("button", { name: "Apply to all springs" }).click();
  await expect(page.locator(".groups li")).toHaveCount(2);
  await expect(sense).toHaveValue(before);
  await constant.fill("-5");
  await page.getByRole("button", { name: "Apply to all springs" }).click();
  await expect(page.getByText("Stiffness: must be greater than 0, not -5")).toBeVisible();
  await expect(page.locator(".groups li")).toHaveCount(2);
});

test("what was done is not foreseen any more", async ({ page, visit }) => {
  await visit("sheet");
  const cells = (await documentOf(page)).figures.springs;
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("Control+a");
  const subdivide = page.getByRole("tabpanel").getByRole("button", { name: "Subdivide" });
  await subdivide.hover();
  await expect(page.locator(".preview-card")).toContainText("Subdivide");
  await subdivide.click();
  await expect(async () => {
    expect((await documentOf(page)).figures.springs).toBeGreaterThan(cells);
  }).toPass();
  await converged(page);
  await expect(page.locator(".preview-card")).toHaveCount(0);
});

test("a stroke that begins beside the net is a stroke", async ({ page, visit }) => {
  await visit("sheet");
  await still(page);
  await page.locator("main.viewport canvas").focus();
  await page.keyboard.press("b");
  const { figures } = await documentOf(page);
  const anchor = await anchorPlace(page, "A1");
  // Left of the net's lower arm, and into it.
  await page.mouse.move(542, 470);
  await page.mouse.down();
  await page.mouse.move(610, 440, { steps: 20 });
  expect(await anchorPlace(page, "A1")).toEqual(anchor);
  await page.mouse.up();
  await expect(async () => {
    expect((await documentOf(page)).figures.springs).toBeGreaterThan(figures.springs);
  }).toPass();
});
