// How the studio is tested: in Chromium, against the real server and engine.
import { defineConfig } from "@playwright/test";

const BROWSER = process.env.CHROMIUM ?? "/usr/bin/chromium";

export default defineConfig({
  testDir: "tests",
  outputDir: "test-results",
  timeout: 180_000,
  expect: { timeout: 30_000 },
  workers: 1,
  reporter: [["list"]],
  projects: [
    { name: "studio", testMatch: "*.spec.ts" },
    // Not a test: `make screenshots` takes the pictures of the documentation.
    { name: "pictures", testMatch: "pictures.ts" },
    // Nor is this: `make bench CASES=studio` has a window measured.
    { name: "measures", testMatch: "measures.ts" },
  ],
  use: {
    actionTimeout: 20_000,
    viewport: { width: 1280, height: 800 },
    colorScheme: "dark",
    launchOptions: {
      executablePath: BROWSER,
      args: [
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
        "--no-sandbox",
        "--disable-background-networking",
        "--disable-quic",
        "--no-first-run",
        "--disable-component-update",
        "--disable-sync",
      ],
    },
  },
});
