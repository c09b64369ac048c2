// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What is printed: two sheets in light colours, without controls, with nothing cut.
import { expect, test } from "@playwright/test";
import type { JsonObject } from "../../src/payload.ts";
import { comparisonReport } from "../comparison_documents.ts";
import { consistencyReport, mixtureReport, saltBoxReport } from "../documents.ts";
import { grasp, monteCarlo, noise, ycbv } from "../study_documents.ts";
import { syntheticReport } from "../synthetic.ts";
import { boxOf, open, scrub } from "./report.ts";

test.setTimeout(180_000);

const run = () => syntheticReport({ frames: 120, objects: 5, hypotheses: 3 });
const pages: [string, () => unknown][] = [
  ["run", run], ["large-run", () => syntheticReport({ frames: 60, objects: 20, hypotheses: 2 })], ["comparison", comparisonReport], ["monte-carlo", monteCarlo],
  ["noise", () => noise(75)], ["ycbv", () => ycbv(40)], ["grasp", grasp], ["mixture", mixtureReport], ["salt-box", saltBoxReport],
];

for (const [name, report] of pages) {
  test(`${name} is printed on two sheets`, async ({ page }) => {
    await page.emulateMedia({ colorScheme: "dark" });
    await open(page, `print-${name}`, report());
    for (const format of ["A4", "Letter"]) {
      const text = (await page.pdf({ format })).toString("latin1");
      expect(text.match(/\/Type\s*\/Page\b/g)?.length, format).toBe(2);
    }
  });
}

test("the sheets have the title, the numbers of the run, the scene and the plots, in light colours", async ({ page }) => {
  await page.emulateMedia({ colorScheme: "dark" });
  await page.setViewportSize({ width: 760, height: 1000 });
  await open(page, "print-sheets", run());
  await scrub(page, 60);
  await page.emulateMedia({ media: "print", colorScheme: "dark" });
  await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
  const sheet = page.locator(".print-sheet");
  await expect(sheet.getByRole("heading", { level: 1 })).toHaveText("synthetic");
  await expect(page.locator("#app")).toBeHidden();
  expect(await page.evaluate(() => document.documentElement.dataset["theme"])).toBe("light");
  await expect(sheet.locator("button, input, select")).toHaveCount(0);
  await expect(sheet.locator("svg.table-chart")).toHaveCount(5);
  await expect(sheet.getByRole("row", { name: /^object-2 120 / })).toBeVisible();
  const ink = await sheet.locator("canvas").evaluate((canvas: HTMLCanvasElement) => {
    const { data } = canvas.getContext("2d")!.getImageData(0, 0, canvas.width, canvas.height);
    return data.filter((value, i) => i % 4 === 3 && value > 100).length;
  });
  expect(ink).toBeGreaterThan(500);
  const [shown, own] = await sheet.locator("canvas").evaluate((canvas: HTMLCanvasElement) => [canvas.clientWidth / canvas.clientHeight, canvas.width / canvas.height]);
  expect(Math.abs(shown / own - 1)).toBeLessThan(0.03);
  for (const part of await sheet.locator("svg, table, canvas, p").all()) {
    const box = await boxOf(part);
    expect(box.x + box.width).toBeLessThanOrEqual(761);
  }
  await page.evaluate(() => dispatchEvent(new Event("afterprint")));
  await page.emulateMedia({ media: "screen", colorScheme: "dark" });
  await expect(sheet).toHaveCount(0);
  expect(await page.evaluate(() => document.documentElement.dataset["theme"])).toBe("dark");
  await expect(page.locator("#app")).toBeVisible();
});

test("the print of a run has the camera's ANEES, its bound beside its errors, and no setting that is cut", async ({ page }) => {
  const report = structuredClone(run());
  const metrics = (report["documents"] as Record<string, JsonObject>)["metrics.json"];
  metrics["camera_consistency"] = { anees: 1.2345 };
  metrics["provenance"] = { program: "posemix", command: "posemix slam a.toml", settings: { values: { noise: `{"mug" = ${"[1, 2], ".repeat(200)}}`, gate: 0.999 } } };
  await open(page, "print-run-facts", report);
  await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
  const sheet = page.locator(".print-sheet");
  await expect(sheet.locator("tr", { hasText: "camera" }).first()).toContainText(/1\.23/);
  await expect(sheet.locator(".print-head")).toContainText("values.gate = 0.999; and 1 more in the page");
  await expect(sheet.locator(".print-head")).not.toContainText("noise");
  await expect(sheet.locator(".print-plots")).toContainText("camera: position error, dashed: 99.7 % bound [mm]");
});

test("a report on consistency is printed as its findings and its NEES, not as the page", async ({ page }) => {
  const report = consistencyReport();
  await open(page, "print-consistency", report);
  await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
  const sheet = page.locator(".print-sheet");
  const pose = (((report["documents"] as Record<string, JsonObject>)["consistency.json"]["poses"]) as JsonObject[])[0];
  for (const finding of pose["findings"] as string[]) await expect(sheet).toContainText(finding);
  await expect(sheet).toContainText("NEES per degree of freedom (expected 1)");
  await expect(sheet.locator("tr", { hasText: `${String(pose["name"])}: rotation` })).toHaveCount(1);
});

test("the print of a comparison has its sentence first, and all runs", async ({ page }) => {
  await open(page, "print-comparison", comparisonReport());
  await page.emulateMedia({ media: "print" });
  await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
  await expect(page.locator(".print-sheet .sentence").first()).toHaveText("riekf fails at tea-box; multi-object and gm-iekf do not fail.");
  await expect(page.locator(".print-sheet thead th")).toHaveText(["", "multi-object", "gm-iekf", "riekf"]);
});
