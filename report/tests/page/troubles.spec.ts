// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What the overview says went wrong: of what, for how long, the worst first.
import { expect, type Page, test } from "@playwright/test";
import { AT, eventfulReport, eventfulTrace, IDS, SD } from "../eventful.ts";
import { packTrace, type TraceJson } from "../pack.ts";
import { open } from "./report.ts";

const item = (page: Page, id: string) => page.locator(".troubles li", { hasText: id });
const withTrace = (json: TraceJson) => eventfulReport({}, { trace: packTrace(json) as never });

/** A run in which nothing is wrong, with the errors that are given. */
function calm(error: (frame: number) => number): TraceJson {
  const json = eventfulTrace();
  for (const track of [json.camera, ...IDS.flatMap((id) => [json.objects[id].world, json.objects[id].relative])]) {
    track.pose = track.truth!.map((pose, k) => [pose![0] + error(k), ...pose!.slice(1)]);
    track.sd = track.pose.map(() => SD);
    track.position_covariance = track.pose.map(() => [SD[3] ** 2, 0, 0, SD[4] ** 2, 0, SD[5] ** 2]);
    track.nees = track.pose.map((_, k) => (error(k) / SD[3]) ** 2);
  }
  for (const id of IDS) {
    const object = json.objects[id];
    object.status = object.status.map(() => "used");
    object.health = object.status.map(() => "good");
    object.register_again = object.status.map(() => false);
  }
  return json;
}

test("wrong mode, how long to register again, all frames beyond 3 sigma, the worst object first", async ({ page }) => {
  const json = eventfulTrace();
  // A frame alone is no event, but it counts.
  const cracker = json.objects["cracker-box"];
  for (const k of [10, 40]) cracker.relative.pose[k] = cracker.relative.truth![k]!.map((value, i) => value + (i === 1 ? 4 * SD[4] : 0));
  const { cart } = json.objects;
  cart.register_again = cart.register_again!.map((_, k) => k >= 260);
  await open(page, "troubles", withTrace(json));
  await expect(page.locator(".troubles li").first()).toContainText("tea-box: on the wrong mode for 6.00 s, first at 0.00 s");
  await expect(page.locator(".troubles button.strong")).toHaveText(["tea-box", "cracker-box", "late-cup", "cart"]);
  await expect(item(page, "late-cup")).toContainText("should be registered again from 22.00 s to 23.90 s.");
  await expect(item(page, "cart")).toContainText("should be registered again from 26.00 s on.");
  await expect(item(page, "cracker-box")).toContainText("a run of 12 detections not explained, at 14.00 s");
  const beyond = cracker.relative.pose.filter((pose, k) => [0, 1, 2].some((i) => Math.abs(pose![i] - cracker.relative.truth![k]![i]) > 3 * SD[3 + i])).length;
  expect(beyond).toBeGreaterThan(AT.dragged[1] - AT.dragged[0]);
  const said = Number((await item(page, "cracker-box").textContent())!.match(/beyond 3 sigma in (\d+) frames/)![1]);
  expect(said).toBeGreaterThanOrEqual(beyond);
  expect(said).toBeGreaterThanOrEqual(AT.dragged[1] - AT.dragged[0] + 1 + 2);
});

test("two runs of detections are counted apart from their detections", async ({ page }) => {
  const json = eventfulTrace();
  const cracker = json.objects["cracker-box"];
  cracker.status = cracker.status.map((word, k) => (k >= 200 && k < 208 ? "doubted" : word));
  await open(page, "troubles-runs", withTrace(json));
  await expect(item(page, "cracker-box")).toContainText("2 runs, 20 detections in all, not explained, the longest at 14.00 s");
});

test("nothing went wrong only where no error is beyond 3 sigma and no mode is wrong", async ({ page }) => {
  await open(page, "troubles-none", withTrace(calm(() => 0.5 * SD[3])));
  await expect(page.locator(".summary")).toContainText("Nothing went wrong that the trace shows");
  await open(page, "troubles-few", withTrace(calm((k) => (k === 30 ? 4 : 0.5) * SD[3])));
  await expect(page.locator(".summary")).not.toContainText("Nothing went wrong");
  await expect(page.locator(".summary")).toContainText("Errors are beyond 3 sigma in 6 of 1800 poses, but never for long.");
});

test("an object out of sight whose covariance covers its error is not wrong but not known", async ({ page }) => {
  const json = calm(() => 0.5 * SD[3]);
  const { cart } = json.objects;
  const hidden = (k: number) => k >= 200 && k < 250;
  cart.detection = cart.detection.map((pose, k) => (hidden(k) ? null : pose));
  for (const track of [cart.world, cart.relative]) {
    track.pose = track.pose.map((pose, k) => (hidden(k) ? [pose![0] + 0.3, ...pose!.slice(1)] : pose));
    track.position_covariance = track.position_covariance!.map((covariance, k) => (hidden(k) ? [0.04, 0, 0, 0.04, 0, 0.04] : covariance));
  }
  await open(page, "troubles-unknown", withTrace(json));
  await expect(page.getByRole("heading", { name: "What was not known" })).toBeVisible();
  await expect(item(page, "cart")).toContainText("its position is not known to better than 600 mm (3 sigma) at worst");
});
