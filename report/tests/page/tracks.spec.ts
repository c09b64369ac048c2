// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Objects that move, come and go.
import { expect, test } from "@playwright/test";
import type { JsonObject } from "../../src/payload.ts";
import { packTrace, type TraceJson } from "../pack.ts";
import { syntheticReport } from "../synthetic.ts";
import { open, openAllTabs, probe, scrub } from "./report.ts";

const FRAMES = 100;
const frames = <T>(make: (frame: number) => T) => Array.from({ length: FRAMES }, (_, frame) => make(frame));

/** A cup that is carried along a bow and put down, a mug that is good for ever, and a box that is lost for a while. */
function movingTrace(): TraceJson {
  const turn = (angle: number) => [0, 0, Math.sin(angle / 2), Math.cos(angle / 2)];
  const sd = frames(() => [0.01, 0.02, 0.03, 0.01, 0.01, 0.01]);
  const covariance = frames(() => [1e-4, 2e-5, 0, 2e-4, 0, 1e-4]);
  const part = (pose: (number[] | null)[], truth: number[][] | null = null) => ({ pose, sd: pose.map((at, k) => at && sd[k]), position_covariance: pose.map((at, k) => at && covariance[k]), truth });
  const along = (frame: number) => Math.min(1, Math.max(0, (frame - 20) / 50));
  const cup = frames((k) => [0.6 * along(k) - 0.3, 0.2 * Math.sin(Math.PI * along(k)), 0.3 * Math.sin(Math.PI * along(k)), ...turn(along(k))]);
  const box = frames((k) => (k < 10 ? null : [0.1, -0.3, 0, ...turn(1)]));
  const mug = frames(() => [-0.2, -0.2, 0, ...turn(0)]);
  const object = (pose: (number[] | null)[]) => ({
    world: part(pose, pose.every((at) => at) ? (pose as number[][]) : null), relative: part(pose), detection: pose, status: pose.map((p) => (p ? "used" : "none")),
    mode_probability: pose.map((p) => (p ? 0.9 : null)), alternatives: pose.map(() => []),
    existence: pose.map((p, k) => (p ? 1 - 0.7 * Math.exp(-k / 5) : null)), register_again: pose.map(() => false),
    health: pose.map((p, k): string => (!p ? "none" : k < 15 ? "tentative" : "good")),
  });
  const moves = frames((k) => (k >= 20 && k < 70 ? [0.05, 0.9, 0.05] : [0.97, 0.01, 0.02]));
  const lost = object(box);
  lost.health = lost.health.map((word, k): string => (k >= 60 && k < 85 ? "lost" : word));
  lost.register_again = lost.health.map((word, k) => word === "lost" && k >= 75);
  lost.existence = lost.existence.map((share, k) => (share === null ? null : k >= 60 && k < 85 ? share * Math.exp((60 - k) / 12) : share));
  return {
    name: "moving", method: "multi-object", frames: FRAMES, stamps_s: frames((k) => 0.1 * k), order: ["cup", "mug", "box"],
    camera: part(frames((k) => [0.4 * Math.sin(k / 40), -1.2, 0.6, -Math.SQRT1_2, 0, 0, Math.SQRT1_2])),
    objects: { cup: { ...object(cup), model_names: ["static", "constant_velocity", "constant_velocity"], models: moves }, mug: object(mug), box: lost },
    hypotheses: frames(() => []),
  };
}

function report(trace: TraceJson): JsonObject {
  return { schema: 1, type: "posemix.report", kind: "slam", title: "moving", program: "", documents: {}, trace: packTrace(trace) as unknown as JsonObject };
}

test("tracks have their tab, states and paths", async ({ page }) => {
  const complaints = await open(page, "tracks", report(movingTrace()));
  await page.getByRole("tab", { name: "Tracks" }).click();
  await expect(page.locator("[role=tabpanel]:not([hidden]) figcaption")).toHaveText(["health of the tracks", "probability that the object exists", "models of motion of cup"]);
  await expect(page.locator("[role=tabpanel]:not([hidden]) .plot-legend")).toContainText("constant velocity 2");
  await expect(page.getByText("A line above a band")).toBeVisible();
  const track = (id: string) => page.locator(`#state tr[data-entity="${id}"]`).locator("td").last();
  await scrub(page, 30);
  await expect(track("box")).toHaveText("good");
  expect(await probe(page, "faint")).toBe(0);
  await scrub(page, 12);
  expect(await probe(page, "faint")).toBe(3);
  await scrub(page, 80);
  await expect(track("box")).toHaveText("lost, register again");
  await expect(track("mug")).toHaveText("good");
  expect(await probe(page, "faint")).toBe(1);
  await expect(page).toHaveScreenshot("run-tracks.png");
  const scene = page.locator(".slam .viewport").first();
  const before = await scene.screenshot();
  await page.getByRole("checkbox", { name: "Paths of objects" }).uncheck();
  await page.waitForTimeout(100);
  expect((await scene.screenshot()).equals(before)).toBe(false);
  await openAllTabs(page);
  expect(complaints).toEqual([]);
});

test("tracks on a phone: nothing sticks out", async ({ page }) => {
  await page.setViewportSize({ width: 390, height: 780 });
  await open(page, "tracks-phone", report(movingTrace()));
  await scrub(page, 80);
  await page.getByRole("tab", { name: "Tracks" }).click();
  expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(390);
});

test("where nothing moves or is lost and all is confirmed, the page is as without tracks", async ({ page }) => {
  const trace = movingTrace();
  trace.order = ["mug"];
  trace.objects = { mug: trace.objects["mug"] };
  for (const [name, payload] of [["all-good", report(trace)], ["no-tracks", syntheticReport({ frames: 50, objects: 2, hypotheses: 2 })]] as const) {
    await open(page, name, payload);
    await expect(page.getByRole("tab", { name: "Tracks" })).toHaveCount(0);
    await expect(page.getByRole("checkbox", { name: "Paths of objects" })).toHaveCount(0);
    await expect(page.getByRole("columnheader", { name: "exists" })).toHaveCount(0);
    expect(await probe(page, "faint")).toBe(0);
  }
});
