// Takes the pictures of the documentation: every panel and state, into docs/pictures/studio.
import { join } from "node:path";
import type { Page } from "@playwright/test";
import { test } from "./studio";

const FOLDER = join(import.meta.dirname, "../../docs/pictures/studio");

async function take(page: Page, name: string): Promise<void> {
  await page.waitForTimeout(600);
  await page.screenshot({ path: join(FOLDER, `${name}.png`) });
}

test("start page", async ({ page, open }) => {
  await open();
  await page.waitForTimeout(1500);
  await take(page, "start");
});

test("net", async ({ page, open }) => {
  await open("three-cylinders");
  await take(page, "net");
  await page.keyboard.press("c");
  await page.keyboard.press("t");
  await page.keyboard.press("w");
  await take(page, "net-skin-reactions");
});
