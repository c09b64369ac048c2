// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What a frame and loading cost on the processor. Headless browsers draw in software, so frames per second say nothing here.
import { statSync } from "node:fs";
import { expect, type Page, test } from "@playwright/test";
import { syntheticReport } from "../synthetic.ts";
import { open, placeOf, probe } from "./report.ts";

const LIMIT_MS = 8;

const median = (values: number[]) => values.sort((a, b) => a - b)[Math.floor(values.length / 2)];

/** Moves the timeline here and there and returns how long each frame took [ms]. */
function scrubMany(page: Page, count: number, frames: number): Promise<number[]> {
  return page.getByRole("slider", { name: "Frame" }).evaluate((bar: HTMLInputElement, [times, length]) => {
    return Array.from({ length: times }, (_, i) => {
      bar.value = String((i * 7919) % length);
      bar.dispatchEvent(new Event("input"));
      return window.posemix!["updateTime"] as number;
    });
  }, [count, frames] as const);
}

test("20,000 frames of ten objects with twelve hypotheses: size, and the time of a frame", async ({ page }) => {
  const payload = syntheticReport({ frames: 20000, objects: 10, hypotheses: 12 });
  const complaints = await open(page, "large", payload);
  const megabytes = statSync(placeOf("large")).size / 1e6;
  expect(megabytes).toBeLessThan(15);
  const times: Record<string, number> = {};
  for (const tab of ["Detections", "Errors", "Hypotheses", "Status"]) {
    await page.getByRole("tab", { name: tab }).click();
    times[tab] = median(await scrubMany(page, 60, 20000));
    expect(times[tab], tab).toBeLessThan(LIMIT_MS);
  }
  expect(await probe<number>(page, "ghosts")).toBeGreaterThan(0);
  console.log(`  page ${megabytes.toFixed(1)} MB, first drawn after ${(await probe<number>(page, "firstDraw")).toFixed(0)} ms, frame ${JSON.stringify(times)} ms`);
  expect(complaints).toEqual([]);
});

test("a run of 1152 frames and four objects is drawn within two seconds", async ({ page }) => {
  await open(page, "usual", syntheticReport({ frames: 1152, objects: 4, hypotheses: 3 }));
  let first = await probe<number>(page, "firstDraw");
  // A machine that is busy with something else gets two more chances.
  for (let again = 0; again < 2 && first >= 2000; ++again) {
    await page.reload();
    await page.waitForSelector("html[data-ready]");
    first = await probe<number>(page, "firstDraw");
  }
  console.log(`  first drawn after ${first.toFixed(0)} ms, of which decoding ${(await probe<number>(page, "decodeTime")).toFixed(0)} ms`);
  expect(first).toBeGreaterThan(0);
  expect(first).toBeLessThan(2000);
});
