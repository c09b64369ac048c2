// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A trace as large as pages are made for. How long it takes is measured in report/bench.
import { statSync } from "node:fs";
import { expect, test } from "@playwright/test";
import { syntheticReport } from "../synthetic.ts";
import { open, placeOf, probe, scrub, shownPose } from "./report.ts";

const size = { frames: 20000, objects: 10, hypotheses: 12 };

test("20,000 frames of ten objects with twelve hypotheses: a small page, and every frame can be scrubbed to", async ({ page }) => {
  test.setTimeout(300_000);
  const complaints = await open(page, "large", syntheticReport(size));
  expect(statSync(placeOf("large")).size / 1e6).toBeLessThan(15);
  for (const tab of ["Detections", "Errors", "Hypotheses", "Status"]) {
    await page.getByRole("tab", { name: tab }).click();
    const places: number[][] = [];
    for (const frame of [19999, 7919, 0]) {
      await scrub(page, frame);
      expect(await probe(page, "frame"), tab).toBe(frame);
      expect(await probe<number>(page, "ghosts"), tab).toBeGreaterThan(0);
      places.push((await shownPose(page, "camera"))!.position);
    }
    // The camera goes round at two metres and never stands still.
    for (const [x, y] of places) expect(Math.abs(Math.hypot(x, y) - 2), tab).toBeLessThan(0.02);
    expect(places[1], tab).not.toEqual(places[2]);
  }
  expect(await probe<number>(page, "firstDraw")).toBeGreaterThan(0);
  expect(complaints).toEqual([]);
});
