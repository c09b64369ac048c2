// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Errors, their statistics, and what sigmas and probabilities are worth, against a run of known errors.
import { expect, type Page, test } from "@playwright/test";
import type { JsonObject } from "../../src/payload.ts";
import { FACTORS, FRAMES, riverReport, riverTrace, SIGMA_M, STEP_S, WRONG } from "../river_trace.ts";
import { syntheticReport } from "../synthetic.ts";
import { open, openAllTabs } from "./report.ts";

const panel = (page: Page) => page.locator("[role=tabpanel]:not([hidden])");

async function openTab(page: Page, name: string): Promise<void> {
  await page.getByRole("tab", { name, exact: true }).click();
}

const note = (page: Page, title: string) => panel(page).locator(".chart", { has: page.locator("figcaption", { hasText: title }) }).first().locator(".note");
const cell = async (page: Page, key: string) => Number(await panel(page).locator(`[data-key="${key}"]`).getAttribute("data-value"));

/** Errors of the camera along an axis over its sigma. */
function ratios(axis: number): number[] {
  const { camera } = riverTrace();
  return camera.pose.map((pose, k) => (camera.truth![k]![axis] - pose![axis]) / SIGMA_M);
}

test("captions say what share is within 3 sigma, and which axis is overconfident or cautious", async ({ page }) => {
  await open(page, "errors-captions", riverReport());
  await openTab(page, "Errors");
  await page.getByRole("combobox", { name: "Pose of" }).selectOption("camera");
  for (const [axis, name, verdict] of [[0, "x", "consistent"], [1, "y", "overconfident"], [2, "z", "cautious"]] as const) {
    const values = ratios(axis);
    const share = (100 * values.filter((ratio) => Math.abs(ratio) <= 3).length) / FRAMES;
    const text = (await note(page, `position ${name} [mm]`).textContent())!;
    expect(text).toContain("(99.7 % expected)");
    expect(text).toContain(verdict);
    expect(Math.abs(Number(text.match(/^([\d.]+) %/)![1]) - share)).toBeLessThan(0.6);
  }
  // Frames beyond 6 sigma are told apart.
  const usual = ratios(1).filter((ratio) => Math.abs(ratio) <= 6);
  const factor = Math.sqrt(usual.reduce((sum, ratio) => sum + ratio * ratio, 0) / usual.length);
  expect(Math.abs(factor - FACTORS[1])).toBeLessThan(0.2);
  await expect(note(page, "position y [mm]")).toContainText(`sigma is ${factor.toFixed(1)} times too small`);
});

test("the statistics are those of evo", async ({ page }) => {
  const { camera } = riverTrace();
  await open(page, "errors-evo", riverReport());
  await openTab(page, "Errors");
  await page.getByRole("combobox", { name: "Pose of" }).selectOption("camera");
  const errors = camera.pose.map((pose, k) => 1000 * Math.hypot(...[0, 1, 2].map((i) => pose![i] - camera.truth![k]![i]))).sort((a, b) => a - b);
  const mean = errors.reduce((sum, error) => sum + error, 0) / FRAMES;
  const expected = {
    rmse: Math.sqrt(errors.reduce((sum, error) => sum + error ** 2, 0) / FRAMES), mean, median: 0.5 * (errors[FRAMES / 2 - 1] + errors[FRAMES / 2]),
    std: Math.sqrt(errors.reduce((sum, error) => sum + (error - mean) ** 2, 0) / FRAMES), min: errors[0], max: errors[FRAMES - 1],
  };
  for (const [key, value] of Object.entries(expected)) expect(Math.abs((await cell(page, `ape/translation/${key}`)) - value), key).toBeLessThan(0.02);
  expect(await cell(page, "ape/rotation/count")).toBe(FRAMES);
  await page.getByRole("combobox", { name: "RPE over" }).selectOption({ label: "5 s" });
  await expect(panel(page).getByRole("rowheader", { name: "RPE over 5 s, translation [mm]" })).toBeVisible();
  expect(await cell(page, "rpe/translation/count")).toBe(FRAMES - 5 / STEP_S);
  await page.getByRole("combobox", { name: "RPE over" }).selectOption({ label: "0.5 m" });
  const pairs = await cell(page, "rpe/translation/count");
  expect(pairs).toBeGreaterThan(100);
  expect(pairs).toBeLessThan(FRAMES);
  // The whole map a metre off: an error, but not after alignment.
  const moved = riverTrace();
  for (const pose of moved.camera.pose) pose![0] += 1;
  await open(page, "errors-aligned", riverReport(moved));
  await openTab(page, "Errors");
  await page.getByRole("combobox", { name: "Pose of" }).selectOption("camera");
  expect(await cell(page, "ape/translation/rmse")).toBeGreaterThan(900);
  await page.getByRole("combobox", { name: "Alignment" }).selectOption("se3");
  expect(Math.abs((await cell(page, "ape/translation/rmse")) - expected.rmse)).toBeLessThan(0.3);
});

test("the table of coverage has the shares of the run, NEES its band, and sentences the verdict", async ({ page }) => {
  await open(page, "consistency-truth", riverReport());
  await openTab(page, "Consistency");
  await page.getByRole("combobox", { name: "Pose of" }).selectOption("camera");
  for (const [axis, name] of ["x", "y", "z"].entries()) {
    const cells = await panel(page).locator(`tr[data-axis="position ${name}"] td`).allTextContents();
    [1, 2, 3].forEach((limit, i) => {
      const share = (100 * ratios(axis).filter((ratio) => Math.abs(ratio) <= limit).length) / FRAMES;
      expect(Math.abs(parseFloat(cells[i].replace(">", "")) - share)).toBeLessThan(1.1);
    });
    expect(cells[4]).toContain(["consistent", "overconfident", "cautious"][axis]);
  }
  const lefts = await panel(page).locator("table.coverage :is(thead th, tbody tr:first-child td):last-child").evaluateAll((cells) => cells.map((cell) => {
    const { textAlign, paddingLeft } = getComputedStyle(cell);
    return [textAlign, cell.getBoundingClientRect().left + parseFloat(paddingLeft)];
  }));
  expect(lefts[0]).toEqual(lefts[1]);
  // One frame in twenty has a NEES of 30, the others 6: in the band of 1.24 to 14.45.
  await expect(note(page, "NEES")).toHaveText("95 % of 400 frames within 1.24 to 14.45 (95 % expected), 5 % above (2.5 % expected)");
  const mean = (30 * 20 + 6 * 380) / 400 / 6;
  await expect(panel(page).locator(".findings li").first()).toContainText(`ANEES ${mean.toPrecision(3).replace(/0$/, "")} per degree of freedom`);
  await expect(panel(page).locator(".findings")).toContainText("Overconfident along: position y (sigma");
  await expect(panel(page).locator(".findings")).toContainText(/largest against their covariance along \(.+\) of the world, nearly y: [12]\.\d times sigma/);
});

test("reliability: what is said with 55 % and never right is a bin of no right frames, right is as defined", async ({ page }) => {
  const trace = riverTrace();
  await open(page, "consistency-modes", riverReport(trace));
  await openTab(page, "Consistency");
  const wrong = WRONG.last - WRONG.first + 1;
  const bin = (k: number, key: string) => cell(page, `reliability/${k}/${key}`);
  expect(await bin(5, "frames")).toBe(wrong);
  expect(await bin(5, "right")).toBe(0);
  expect(Math.abs((await bin(5, "said")) - 0.55)).toBeLessThan(1e-3);
  const sure = ["box", "cup"].flatMap((id) => trace.objects[id].mode_probability!).filter((said) => said! >= 0.9).length;
  expect(await bin(9, "frames")).toBe(sure);
  expect(await bin(9, "right")).toBe(1);
  await expect(panel(page)).toContainText("within 20 deg and 10 cm of the truth");
  await expect(panel(page).locator(".findings")).toContainText(`over the ${FRAMES - wrong} of ${FRAMES} frames on the right mode`);
});

test("without truth: no word of errors, spread and innovations in their place, and the tab says so", async ({ page }) => {
  const complaints = await open(page, "consistency-no-truth", riverReport(riverTrace(false)));
  await expect(page.getByRole("tab", { name: "Errors" })).toHaveCount(0);
  await openTab(page, "Spread");
  await expect(panel(page)).toContainText("There is no ground truth for this pose, so no error is known");
  expect((await panel(page).locator("figcaption, .entry").allTextContents()).join()).not.toMatch(/error/);
  await expect(panel(page).locator(".statistics > *")).toHaveCount(0);
  await openTab(page, "Consistency");
  await expect(panel(page)).toContainText("There is no ground truth: the NIS of the innovations takes the place of the NEES");
  await expect(panel(page).locator("figcaption")).toHaveText([/^NIS/]);
  const { cup } = riverTrace(false).objects;
  const values = cup.nis!.filter((value) => value !== null);
  const within = values.filter((value) => value! < 14.45).length / values.length;
  await expect(note(page, "NIS")).toHaveText(new RegExp(`^${(100 * within).toFixed(0)} % of ${values.length} frames within`));
  await openAllTabs(page);
  expect(complaints).toEqual([]);
});

test("a run without NEES, NIS and truth has no such tab; with truth alone it has coverage", async ({ page }) => {
  const blind = riverTrace(false);
  for (const object of Object.values(blind.objects)) delete object.nis;
  await open(page, "consistency-none", riverReport(blind));
  await expect(page.getByRole("tab", { name: "Consistency" })).toHaveCount(0);
  await open(page, "consistency-old", syntheticReport({ frames: 80, objects: 2, hypotheses: 2 }) as JsonObject);
  await openTab(page, "Consistency");
  await expect(panel(page)).toContainText("This report has no NEES of this pose");
  await expect(panel(page).locator("table.coverage tbody tr")).toHaveCount(6);
});

test("the choices of rotation and frame are shared by the tabs", async ({ page }) => {
  await open(page, "errors-shared", riverReport());
  await openTab(page, "Detections");
  await page.getByRole("combobox", { name: "Rotation as", exact: true }).selectOption("rpy");
  await expect(panel(page).locator("figcaption", { hasText: "yaw" })).toBeVisible();
  await openTab(page, "Errors");
  await expect(panel(page).locator("figcaption", { hasText: "roll [deg]" })).toBeVisible();
  await page.getByRole("combobox", { name: "in the frame of" }).selectOption("world");
  await openTab(page, "Consistency");
  await expect(panel(page).getByRole("combobox", { name: "in the frame of" })).toHaveValue("world");
  await page.getByRole("combobox", { name: "Pose of" }).selectOption("camera");
  await expect(panel(page).getByRole("combobox", { name: "in the frame of" })).toHaveCount(0);
});
