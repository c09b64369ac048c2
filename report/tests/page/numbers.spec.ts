// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { expect, type Page, test } from "@playwright/test";
import type { JsonObject } from "../../src/payload.ts";
import { syntheticReport } from "../synthetic.ts";
import { open } from "./report.ts";

const HASH = "70a40ab1a8abd47a3c2f907cfa5643646da2fe016b8bb1bbb91d1996caa971e8";

/** The report of a small run whose metrics.json has more. */
function report(change: (metrics: JsonObject, objects: Record<string, JsonObject>) => void): JsonObject {
  const made = structuredClone(syntheticReport({ frames: 20, objects: 3, hypotheses: 2 })) as JsonObject;
  const metrics = (made["documents"] as Record<string, JsonObject>)["metrics.json"];
  change(metrics, metrics["objects"] as Record<string, JsonObject>);
  return made;
}

const heads = (page: Page) => page.locator("#metrics table", { hasText: "Detections and modes" }).getByRole("columnheader").allTextContents();

test("what was gated has a name of its own beside what was not explained, and in older files it is that", async ({ page }) => {
  const counted = (keys: JsonObject) => report((_, objects) => Object.values(objects).forEach((object) => {
    delete object["gated"];
    delete object["unexplained"];
    Object.assign(object, { detections: 30, ...keys });
  }));
  await open(page, "numbers-gated", counted({ gated: 2, unexplained: 7 }));
  await page.getByRole("tab", { name: "Numbers" }).click();
  const names = await heads(page);
  expect(new Set(names).size).toBe(names.length);
  expect(names).toEqual(expect.arrayContaining(["outside the gate", "not explained"]));
  await open(page, "numbers-gated-older", counted({ gated: 2 }));
  await page.getByRole("tab", { name: "Numbers" }).click();
  expect(await heads(page)).toContain("not explained");
});

test("consistency has a row per object and words, and verdicts a table with the camera", async ({ page }) => {
  const judged = (verdict: string, reason: string) => ({ verdict, reason, anees: 2.5, interval: [1.25, 4.5], effective_frames: 12.5 });
  await page.setViewportSize({ width: 390, height: 844 });
  let ids: string[] = [];
  const complaints = await open(page, "numbers-verdicts", report((metrics, objects) => {
    ids = Object.keys(objects);
    metrics["consistency"] = {
      relative_anees: Object.fromEntries(ids.map((id, i) => [id, 1 + i])), right_mode_relative_anees: Object.fromEntries(ids.map((id) => [id, 0.9])),
      camera_verdict: judged("consistent", ""),
      relative_verdicts: Object.fromEntries(ids.map((id, i) => [id, i === 2 ? null : judged("overconfident", "15 % of position y outside 3 sigma")])),
      runs_of_errors: 4,
    };
  }));
  await page.getByRole("tab", { name: "Numbers" }).click();
  const table = (caption: string) => page.locator("#metrics").getByRole("region", { name: caption, exact: true }).getByRole("table");
  const texts = (caption: string, row: string) => table(caption).locator(`tbody tr[data-entity="${row}"] td`).allTextContents();
  const seen = table("Consistency as seen from the camera");
  await expect(seen.first().getByRole("columnheader")).toHaveText(["NEES", "NEES near the truth"]);
  await expect(seen.first().getByRole("rowheader")).toHaveText(ids);
  expect(await seen.first().locator(`tbody tr[data-entity="${ids[1]}"] td`).allTextContents()).toEqual(["2", "0.900"]);
  // What is not by object does not make one row of all.
  await expect(seen.last().getByRole("columnheader")).toHaveText(["runs of errors"]);
  const verdicts = "Are errors as large as the covariances say?";
  await expect(table(verdicts).getByRole("columnheader")).toHaveText(["verdict", "NEES, mean", "NEES, 95 % interval", "independent frames", "most at fault"]);
  await expect(table(verdicts).getByRole("rowheader")).toHaveText(["camera", ...ids]);
  expect(await texts(verdicts, "camera")).toEqual(["consistent", "2.50", "1.25 to 4.50", "12.5", "–"]);
  expect(await texts(verdicts, ids[0])).toEqual(["overconfident", "2.50", "1.25 to 4.50", "12.5", "15 % of position y outside 3 sigma"]);
  expect(await texts(verdicts, ids[2])).toEqual(["–", "–", "–", "–", "–"]);
  await expect(page.locator(`#metrics [data-key="consistency/relative_verdicts/${ids[0]}/interval"]`)).toHaveAttribute("data-value", "[1.25,4.5]");
  // Heads stand above their words.
  const left = (at: ReturnType<typeof table>) => at.evaluate((node) => getComputedStyle(node).textAlign);
  expect(await left(table(verdicts).getByRole("columnheader", { name: "verdict" }))).toBe("left");
  expect((await page.locator("#metrics thead th").allTextContents()).join()).not.toContain("/");
  await page.getByText("Words", { exact: true }).click();
  await expect(page.locator("#metrics dt").filter({ hasText: /^most at fault$/ })).toBeVisible();
  expect(complaints).toEqual([]);
});

test("hashes are folded and short, and no table is wider for them", async ({ page }) => {
  await open(page, "numbers-hashes", report((metrics) => Object.assign(metrics, {
    run: HASH.slice(0, 32), files: Object.fromEntries(Array.from({ length: 16 }, (_, i) => [`detections_of_object_${i}.tum`, HASH])),
  })));
  await page.getByRole("tab", { name: "Numbers" }).click();
  const widest = await page.locator("#metrics .scroll").evaluateAll((nodes) => Math.max(...nodes.map((node) => node.scrollWidth)));
  expect(widest).toBeLessThan(1500);
  await expect(page.locator("#metrics .scroll").filter({ hasText: HASH.slice(0, 12) })).toHaveCount(0);
  const last = page.locator('#metrics [data-key="files/detections_of_object_15.tum"]');
  await expect(last).toBeHidden();
  await page.getByText("SHA-256 of its files").click();
  await expect(last).toHaveText(`${HASH.slice(0, 12)}…`);
  await expect(last).toHaveAttribute("title", HASH);
});

test("a run without truth has no comparison of filter and detector", async ({ page }) => {
  const paired = (frames: number) => report((_, objects) => Object.values(objects).forEach((object) => {
    const error = { position_median_m: frames > 0 ? 0.003 : 0, rotation_median_deg: frames > 0 ? 1.5 : 0 };
    object["paired"] = { frames, estimate: error, detection: error };
  }));
  const table = page.locator("#metrics table", { hasText: "Filter and detector over the same frames" });
  await open(page, "numbers-paired", paired(15));
  await page.getByRole("tab", { name: "Numbers" }).click();
  await expect(table).toHaveCount(1);
  await open(page, "numbers-unpaired", paired(0));
  await page.getByRole("tab", { name: "Numbers" }).click();
  await expect(table).toHaveCount(0);
});
