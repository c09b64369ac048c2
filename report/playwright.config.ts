// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { defineConfig } from "@playwright/test";

export default defineConfig({
  testDir: "tests/page",
  workers: 2,
  timeout: 120_000,
  reporter: [["list"]],
  snapshotPathTemplate: "tests/golden/{arg}{ext}",
  // Beside other work a browser may stand still for seconds: an expectation waits longer than the five of the default.
  // Fonts and software rendering differ a little between machines.
  expect: { timeout: 15_000, toHaveScreenshot: { maxDiffPixelRatio: 0.04, animations: "disabled" } },
  use: {
    browserName: "chromium",
    viewport: { width: 1280, height: 1000 },
    launchOptions: {
      executablePath: process.env["POSEMIX_CHROMIUM"] ?? "/usr/bin/chromium",
      args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
    },
  },
});
