// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { expect, test } from "@playwright/test";
import type { JsonObject } from "../../src/payload.ts";
import { wordOf } from "../../src/pages/words.ts";
import { packTrace, type TraceJson } from "../pack.ts";
import { syntheticMetrics, syntheticReport } from "../synthetic.ts";
import { boxOf, open, probe, scrub, type ShownPose, shownPose } from "./report.ts";

const small = { frames: 120, objects: 3, hypotheses: 4 };

/** Three frames of a camera and two objects, one of which comes late. */
function shortTrace(): TraceJson {
  const turn = (angle: number) => [0, 0, Math.sin(angle / 2), Math.cos(angle / 2)];
  const sd = [[0.01, 0.02, 0.03, 0.1, 0.1, 0.1], [0.01, 0.02, 0.03, 0.1, 0.1, 0.1], [0.01, 0.02, 0.03, 0.1, 0.1, 0.1]];
  const covariance = sd.map(() => [1e-4, 2e-5, 0, 4e-4, 0, 9e-4]);
  const mug = [0, 1, 2].map((i) => [0.3, 0.1 * i, 0.05, ...turn(0.4 * i)]);
  const cup = [null, [-0.2, 0, 0.123456789, ...turn(3)], [-0.2, 0, 0.2, ...turn(3.1)]];
  const part = (pose: (number[] | null)[]) => ({ pose, sd, position_covariance: covariance, truth: null });
  const object = (pose: (number[] | null)[], id: number) => ({
    world: part(pose), relative: part(pose), detection: pose, status: pose.map((p) => (p ? "used" : "none")),
    mode_probability: pose.map((p) => (p ? 0.75 : null)),
    alternatives: pose.map((p) => (p ? [{ id, probability: 0.75, pose: p }, { id: id + 1, probability: 0.25, pose: [9, 9, 9, 0, 0, 0, 1] }] : [])),
  });
  return {
    name: "short", method: "multi-object", frames: 3, stamps_s: [7, 7.5, 9], order: ["mug", "cup"],
    camera: part([0, 1, 2].map((i) => [i, -1.5, 0.25, ...turn(i)])), objects: { mug: object(mug, 0), cup: object(cup, 5) }, hypotheses: [[], [], []],
  };
}

function report(trace: TraceJson): JsonObject {
  return { schema: 1, type: "posemix.report", kind: "slam", title: "short", program: "", documents: {}, trace: packTrace(trace) as unknown as JsonObject };
}

function expectPose(shown: ShownPose | undefined, pose: number[] | null): void {
  if (pose === null) return expect(shown).toBeUndefined();
  expect(shown).toBeDefined();
  pose.slice(0, 3).forEach((value, i) => expect(Math.abs(shown!.position[i] - value)).toBeLessThanOrEqual(0.51e-5));
  const dot = pose.slice(3).reduce((sum, value, i) => sum + value * shown!.quaternion[i], 0);
  expect(1 - Math.abs(dot)).toBeLessThan(1e-8);
}

test("what is drawn is what the trace says, frame by frame", async ({ page }) => {
  const trace = shortTrace();
  await open(page, "short", report(trace));
  for (const frame of [0, 1, 2]) {
    await scrub(page, frame);
    expect(await probe(page, "frame")).toBe(frame);
    expectPose(await shownPose(page, "camera"), trace.camera.pose[frame]);
    for (const id of trace.order) expectPose(await shownPose(page, id), trace.objects[id].world.pose[frame]);
    expect(await probe(page, "ghosts")).toBe(frame === 0 ? 1 : 2);
  }
  const cells = page.locator("#state tr", { hasText: "cup" }).locator("td");
  await expect(cells).toHaveText(["-0.2000± 30.0", "0.0000± 60.0", "0.2000± 90.0", /^0\.0, 0\.0, 177\.6± 1\.72, 3\.44, 5\.1[56]$/, "used", "2: 75, 25 %", "75.0 %"]);
  await expect(page.locator("output.time")).toHaveText("2.00 s · frame 2 / 2");
});

test("the table of numbers is metrics.json", async ({ page }) => {
  await open(page, "metrics", syntheticReport(small));
  await page.getByRole("tab", { name: "Numbers" }).click();
  const shown = await page.locator("#metrics [data-key]").evaluateAll((cells) =>
    cells.map((cell) => [cell.getAttribute("data-key")!, cell.getAttribute("data-value")!, cell.textContent!]),
  );
  const leaves = new Map<string, unknown>();
  const collect = (value: unknown, path: string) => {
    if (typeof value === "object" && value !== null) for (const [key, inner] of Object.entries(value)) collect(inner, path === "" ? key : `${path}/${key}`);
    else leaves.set(path, value);
  };
  collect(syntheticMetrics(small), "");
  leaves.delete("schema");
  // What is null in all rows has no column.
  const known = [...leaves].filter(([, value]) => value !== null);
  const numbers = new Map(shown.map(([key, value, text]) => [key, { value: JSON.parse(value) as unknown, text }]));
  for (const [key, value] of known) {
    expect(numbers.get(key)?.value, key).toBe(value);
    if (typeof value !== "number") continue;
    const { scale = 1 } = wordOf(key.replace(/^objects\/[^/]+\//, "")) ?? {};
    const { text } = numbers.get(key)!;
    const digits = text.split(".")[1]?.length ?? 0;
    expect(Math.abs(Number(text) - scale * value), key).toBeLessThanOrEqual(0.5001 * 10 ** -digits);
  }
  for (const { value } of numbers.values()) expect(value === null || [...leaves.values()].includes(value)).toBe(true);
  await expect(page.getByRole("columnheader", { name: "position error, rms [mm]" }).first()).toBeVisible();
});

test("scrubbing moves the scene", async ({ page }) => {
  await open(page, "scrub", syntheticReport(small));
  await page.getByRole("tab", { name: "Detections" }).click();
  const canvas = page.locator(".slam .viewport").first();
  const before = await canvas.screenshot();
  const first = (await shownPose(page, "camera"))!.position;
  const mark = page.locator(".chart .playhead").first();
  const place = await mark.evaluate((node) => node.style.transform);
  await scrub(page, 15);
  const second = (await shownPose(page, "camera"))!.position;
  expect(Math.hypot(...second.map((value, i) => value - first[i]))).toBeGreaterThan(1);
  expect(await mark.evaluate((node) => node.style.transform)).not.toBe(place);
  await page.waitForTimeout(100);
  expect((await canvas.screenshot()).equals(before)).toBe(false);
});

test("the keys: arrows, shift, home, end and space", async ({ page }) => {
  await open(page, "keys", syntheticReport(small));
  const frame = () => probe<number>(page, "frame");
  const press = async (key: string, expected: number) => {
    await page.keyboard.press(key);
    expect(await frame()).toBe(expected);
  };
  await press("ArrowRight", 1);
  await press("Shift+ArrowRight", 11);
  await press("ArrowLeft", 10);
  await press("End", 119);
  await press("Home", 0);
  await page.getByRole("slider").focus();
  await press("ArrowRight", 1);
  await page.evaluate(() => (document.activeElement as HTMLElement).blur());
  await page.keyboard.press("Space");
  await expect(page.getByRole("button", { name: "Pause" })).toBeVisible();
  await expect.poll(frame).toBeGreaterThan(5);
  await page.keyboard.press("Space");
  await expect(page.getByRole("button", { name: "Play" })).toBeVisible();
  const stopped = await frame();
  await page.waitForTimeout(150);
  expect(await frame()).toBe(stopped);
});

test("pressing in a plot goes to that time", async ({ page }) => {
  await open(page, "seek", syntheticReport(small));
  await page.getByRole("tab", { name: "Detections" }).click();
  const over = page.locator(".u-over").first();
  const box = await boxOf(over);
  await over.click({ position: { x: box.width / 2, y: 20 } });
  expect(Math.abs((await probe<number>(page, "frame")) - 59.5)).toBeLessThan(2);
});

test("layers go and come back", async ({ page }) => {
  await open(page, "layers", syntheticReport(small));
  expect(await probe(page, "ghosts")).toBe(9);
  await page.getByRole("checkbox", { name: "Hypotheses" }).uncheck();
  expect(await probe(page, "ghosts")).toBe(0);
  await page.getByRole("checkbox", { name: "Hypotheses" }).check();
  expect(await probe(page, "ghosts")).toBe(9);
});

test("every control has a name, tabs follow the arrow keys, and focus is seen", async ({ page }) => {
  await open(page, "names", syntheticReport(small));
  for (const control of await page.locator("button, select, input, [role=img], [role=region]").all()) {
    await expect(control).toHaveAccessibleName(/\S/);
  }
  await page.getByRole("tab", { name: "Detections" }).focus();
  await page.keyboard.press("ArrowRight");
  await expect(page.getByRole("tab", { name: "Errors" })).toBeFocused();
  expect(await page.getByRole("tab", { name: "Errors" }).evaluate((node) => getComputedStyle(node).outlineStyle)).toBe("solid");
  expect(await probe(page, "frame")).toBe(0);
});
