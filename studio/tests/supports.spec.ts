// How nodes are held, moved by hand and by number; what slides lies where it may.
import { anchorPlace, converged, documentOf, expect, nextPicture, test } from "./studio";

test("anchors are dragged level, slide in planes and along lines, and are let go", async ({
  page,
  visit,
}) => {
  await visit("three-cylinders");
  const anchorOf = async (name: string) =>
    (await documentOf(page)).anchors.find((anchor) => anchor.name === name)!;
  const before = await anchorOf("A9");
  const place = await anchorPlace(page, "A9");
  await page.mouse.move(place.x, place.y);
  await page.mouse.down();
  await page.keyboard.down("Control");
  await page.mouse.move(place.x - 30, place.y + 25, { steps: 6 });
  await nextPicture(page);
  await page.mouse.up();
  await page.keyboard.up("Control");
  await expect.poll(async () => (await documentOf(page)).position).toBe(1);
  const level = await anchorOf("A9");
  expect(level.position[2]).toBe(before.position[2]);
  expect(
    Math.hypot(level.position[0] - before.position[0], level.position[1] - before.position[1]),
  ).toBeGreaterThan(0.05);
  await converged(page);

  // In a plane it goes where the net pulls it, and the reaction stands square to the plane.
  const now = await anchorPlace(page, "A9");
  await page.mouse.click(now.x, now.y);
  await page.getByLabel("Support").selectOption("plane");
  const normal = page.getByRole("group", { name: "Normal of the plane" });
  for (const [axis, value] of [
    ["x", "1"],
    ["y", "0"],
    ["z", "2"],
  ]) {
    await normal.getByLabel(axis).fill(value);
    await normal.getByLabel(axis).press("Enter");
  }
  await normal.getByRole("button", { name: "Apply" }).click();
  await expect.poll(async () => (await anchorOf("A9")).plane).toEqual([1, 0, 2]);
  await converged(page);
  const numbers = async (name: string) => {
    const fact = page.locator(".panel-net .fact", { hasText: name }).locator(".fact-value");
    return (await fact.textContent())!
      .replaceAll("−", "-")
      .match(/-?[\d.]+/g)!
      .map(Number);
  };
  await expect
    .poll(async () => {
      const at = await numbers("is now at");
      const off = at.map((value, axis) => value - level.position[axis]);
      return Math.abs(off[0] + 2 * off[2]) < 5e-3 && Math.hypot(...off) > 0.05;
    })
    .toBe(true);
  await expect
    .poll(async () => {
      const [x, y, z] = await numbers("along x, y, z");
      return Math.abs(y) < 2e-3 && Math.abs(2 * x - z) < 5e-3 && Math.hypot(x, z) > 0.1;
    })
    .toBe(true);

  await page.getByLabel("Support").selectOption("z");
  await expect.poll(async () => (await anchorOf("A9")).holds).toBe("z");
  expect((await anchorOf("A9")).plane).toBe(null);
  // A number moves where it is held; to the millimetre.
  const z = page.getByRole("textbox", { name: /^z/ });
  await z.fill("1,234");
  await z.press("Enter");
  await expect.poll(async () => (await anchorOf("A9")).position[2]).toBe(1.234);
  await converged(page);
  expect((await numbers("is now at"))[2]).toBeCloseTo(1.234, 3);

  const { anchors } = await documentOf(page);
  await page.getByLabel("Support").selectOption("free");
  await expect.poll(async () => (await documentOf(page)).anchors.length).toBe(anchors.length - 1);
  await page.getByRole("button", { name: "Undo", exact: true }).click();
  await expect.poll(async () => (await documentOf(page)).anchors).toEqual(anchors);
});
