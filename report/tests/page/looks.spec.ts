// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Pictures of the pages, compared with those in tests/golden (npx playwright test looks --update-snapshots makes them anew).
import { expect, test } from "@playwright/test";
import { mixtureReport, saltBoxReport } from "../documents.ts";
import { syntheticReport } from "../synthetic.ts";
import { open, scrub } from "./report.ts";

const run = () => syntheticReport({ frames: 120, objects: 4, hypotheses: 4 });

test("a run in light", async ({ page }) => {
  await open(page, "look-light", run());
  await scrub(page, 30);
  await expect(page).toHaveScreenshot("run-light.png");
});

test("a run in dark, as the system prefers, and back by the button", async ({ page }) => {
  await page.emulateMedia({ colorScheme: "dark" });
  await open(page, "look-dark", run());
  await page.getByRole("tab", { name: "Errors" }).click();
  await page.getByRole("button", { name: "Objects" }).click();
  await expect(page).toHaveScreenshot("run-dark.png");
  await page.getByRole("button", { name: "Use light colours" }).click();
  expect(await page.evaluate(() => getComputedStyle(document.body).backgroundColor)).toBe("rgb(255, 255, 255)");
});

test("a run on a phone: nothing sticks out", async ({ page }) => {
  await page.setViewportSize({ width: 390, height: 780 });
  await open(page, "look-phone", run());
  await scrub(page, 60);
  for (const tab of await page.getByRole("tab").all()) {
    await tab.click();
    expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(390);
  }
  await page.evaluate(() => scrollTo(0, 0));
  await expect(page).toHaveScreenshot("run-phone.png");
});

test("a mixture", async ({ page }) => {
  await open(page, "look-mixture", mixtureReport());
  await expect(page).toHaveScreenshot("mixture.png");
});

test("the salt box in space", async ({ page }) => {
  await open(page, "look-salt-box", saltBoxReport());
  await page.getByRole("tab", { name: "In space" }).click();
  await expect(page).toHaveScreenshot("salt-box.png");
});
