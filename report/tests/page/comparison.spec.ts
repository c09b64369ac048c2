// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { expect, type Page, test } from "@playwright/test";
import type { JsonObject } from "../../src/payload.ts";
import { comparisonReport, EQUAL, FAILING, GOOD, IDS, runTrace, type RunShape } from "../comparison_documents.ts";
import { open, openAllTabs, probe, scrub } from "./report.ts";

test.setTimeout(180_000);

interface Row {
  entity: string;
  quantity: string;
  values: number[];
  verdicts: string[];
}

/** The root mean square of the camera's position errors [mm], from the trace as the program writes it. */
function cameraRms(shape: RunShape): number {
  const { pose, truth } = runTrace(shape).camera;
  const squares = pose.map((p, i) => [0, 1, 2].reduce((sum, k) => sum + (p![k] - truth![i]![k]) ** 2, 0));
  return 1000 * Math.sqrt(squares.reduce((sum, value) => sum + value, 0) / squares.length);
}

const metric = (page: Page, key: string) => page.locator(`.metrics [data-key="${key}"]`);

test("who failed, when and why stands on top, with links to the moment here and in the run's own page", async ({ page }) => {
  const complaints = await open(page, "comparison", comparisonReport());
  const result = page.getByRole("region", { name: "Result" });
  await expect(result).toContainText("riekf fails at tea-box; multi-object and gm-iekf do not fail.");
  await expect(result).toContainText("turned by 180 deg about its z axis");
  await expect(result).toContainText(/are a tie; riekf has 10\.\d mm/);
  await expect(result.getByRole("link", { name: "in its own page" })).toHaveAttribute("href", "riekf/report.html#t=12.3&object=tea-box");
  expect(await probe(page, "selected")).toBe("tea-box");
  await result.getByRole("link", { name: "riekf: tea-box on the wrong mode from 12.3 s on" }).click();
  expect(await probe(page, "frame")).toBe(123);
  await expect(page.getByRole("tab", { name: "Errors" })).toHaveAttribute("aria-selected", "true");
  await openAllTabs(page);
  expect(complaints).toEqual([]);
});

test("metrics are those of the traces; the best is bold, a tie is called a tie", async ({ page }) => {
  await open(page, "comparison-metrics", comparisonReport());
  const shapes = [GOOD, EQUAL, FAILING];
  const key = (name: string) => `camera in the world/position error, rms/${name}`;
  for (const shape of shapes) {
    const value = Number(await metric(page, key(shape.name)).getAttribute("data-value"));
    // The trace is packed in steps of 0.01 mm.
    expect(Math.abs(value - cameraRms(shape))).toBeLessThan(0.01);
  }
  const best = cameraRms(GOOD) < cameraRms(EQUAL) ? GOOD : EQUAL;
  const other = best === GOOD ? EQUAL : GOOD;
  await expect(metric(page, key(best.name)).locator("strong")).toHaveCount(1);
  await expect(metric(page, key(other.name))).toHaveAttribute("data-verdict", "tie");
  await expect(metric(page, key(other.name))).toContainText(`tie with ${best.name}`);
  await expect(metric(page, key("riekf"))).toHaveAttribute("data-verdict", "worse");
  await expect(metric(page, key("riekf"))).toContainText("p < 0.001");
  await expect(metric(page, "tea-box from the camera/rotation error, rms/riekf")).toContainText("not told apart");
});

test("scenes are overlaid or beside each other, with one timeline and one view", async ({ page }) => {
  await open(page, "comparison-scenes", comparisonReport([GOOD, { ...FAILING, frames: 80 }]));
  expect(await probe(page, "drawn")).toEqual(["multi-object", "riekf"]);
  await scrub(page, 100);
  expect(await probe(page, "drawn")).toEqual(["multi-object"]);
  await scrub(page, 40);
  await page.getByRole("checkbox", { name: "multi-object" }).uncheck();
  expect(await probe(page, "drawn")).toEqual(["riekf"]);
  await page.getByRole("button", { name: "Side by side" }).click();
  expect(await probe(page, "scenes")).toBe(2);
  await expect(page.locator(".beside .viewport canvas:not(.labels)")).toHaveCount(2);
  expect(await probe(page, "besideFrames")).toEqual({ "multi-object": 40, riekf: 40 });
  await scrub(page, 150);
  expect(await probe(page, "besideFrames")).toEqual({ "multi-object": 150, riekf: 79 });
  const before = await probe<number[][]>(page, "eyes");
  await page.locator(".beside .viewport canvas:not(.labels)").first().focus();
  await page.keyboard.press("d");
  await expect.poll(async () => (await probe<number[][]>(page, "eyes"))[0].join()).not.toBe(before[0].join());
  const [left, right] = await probe<number[][]>(page, "eyes");
  left.forEach((value, i) => expect(Math.abs(value - right[i])).toBeLessThan(1e-6));
});

test("the state stands in the address, and the errors follow the selected object", async ({ page }) => {
  await open(page, "comparison-address", comparisonReport());
  await page.getByRole("tab", { name: "Errors" }).click();
  await expect(page.locator("figcaption").filter({ hasText: "tea-box from the camera: rotation" })).toHaveCount(1);
  await page.getByRole("combobox", { name: "Errors of" }).selectOption("mug");
  await expect(page.locator("figcaption").filter({ hasText: "mug from the camera: rotation" })).toHaveCount(1);
  await scrub(page, 70);
  await expect.poll(() => page.evaluate(() => location.hash)).toContain("t=7");
  expect(await page.evaluate(() => location.hash)).toContain("object=mug");
});

test("runs of different length and without truth are shown, and this is said", async ({ page }) => {
  const complaints = await open(page, "comparison-no-truth", comparisonReport([{ ...GOOD, truth: false }, { ...FAILING, truth: false, frames: 180 }]));
  const result = page.getByRole("region", { name: "Result" });
  await expect(result).toContainText("The runs disagree on tea-box.");
  await expect(result).toContainText("There is no ground truth: which run is better cannot be said");
  await expect(result).toContainText("riekf 180 frames, 0.0 to 17.9 s");
  await openAllTabs(page);
  await expect(page.getByRole("tab", { name: "Errors" })).toHaveCount(0);
  expect((await probe<Row[]>(page, "rows")).some(({ quantity }) => quantity.includes("error"))).toBe(false);
  expect(complaints).toEqual([]);
});

test("colours of runs are the same in scene, table and plots", async ({ page }) => {
  await open(page, "comparison-colours", comparisonReport());
  const runs = await probe<{ name: string; colour: string }[]>(page, "runs");
  expect(new Set(runs.map(({ colour }) => colour)).size).toBe(3);
  for (const { name, colour } of runs) {
    const of = (selector: string) => page.locator(selector).filter({ hasText: name }).first().evaluate((node) => (node as HTMLElement).style.getPropertyValue("--swatch"));
    expect(await of(".metrics th.run")).toBe(colour);
    expect(await of(".toggles .toggle")).toBe(colour);
  }
});

test("names are text, and links go nowhere else", async ({ page }) => {
  const evil = '<img src=x onerror="window.hacked=1">';
  const complaints = await open(page, "comparison-evil", comparisonReport([{ ...GOOD, name: evil, report: "javascript:window.hacked=1" }, { ...FAILING, report: "../../secret/report.html" }]));
  await openAllTabs(page);
  expect(await page.evaluate(() => "hacked" in window)).toBe(false);
  expect(await page.locator("#app img").count()).toBe(0);
  for (const link of await page.locator("#app a").all()) expect(await link.getAttribute("href")).toMatch(/^#t=/);
  expect(complaints).toEqual([]);
});

const broken: [string, JsonObject, RegExp][] = [
  ["one run", { runs: (comparisonReport()["runs"] as JsonObject[]).slice(0, 1) }, /needs "runs", two or more/],
  ["no trace", { runs: [{ name: "a" }, { name: "b" }] }, /needs a "trace"/],
  ["damaged", { runs: (comparisonReport()["runs"] as JsonObject[]).map((run) => ({ ...run, trace: { ...(run["trace"] as JsonObject), data: "AAAA" } })) }, /Run multi-object: The trace is damaged/],
];
for (const [name, more, message] of broken) {
  test(`a comparison that cannot be shown says why: ${name}`, async ({ page }) => {
    const complaints = await open(page, `comparison-broken-${name.replace(" ", "-")}`, comparisonReport([GOOD, EQUAL], more));
    await expect(page.getByRole("alert")).toContainText(message);
    expect(complaints).toEqual([]);
  });
}

test("an object that one run lacks is a failure, and no page error", async ({ page }) => {
  const report = comparisonReport([GOOD, EQUAL]);
  const second = (report["runs"] as { trace: { order: string[] } }[])[1];
  second.trace.order = second.trace.order.filter((id) => id !== IDS[0]);
  const complaints = await open(page, "comparison-lacks", report);
  await expect(page.getByRole("region", { name: "Result" })).toContainText("gm-iekf: mug without an estimate in all frames");
  expect(complaints).toEqual([]);
});
