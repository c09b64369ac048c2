// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Reports that the program wrote, in the folder $POSEMIX_REPORT_INPUTS (tools/report_inputs).
import { readdirSync, readFileSync } from "node:fs";
import path from "node:path";
import { pathToFileURL } from "node:url";
import { expect, test } from "@playwright/test";
import type { JsonObject } from "../../src/payload.ts";
import type { TraceJson } from "../pack.ts";
import { openAllTabs, probe, scrub, shownPose, watch } from "./report.ts";

const inputs = process.env["POSEMIX_REPORT_INPUTS"] ?? "";
const json = <T>(folder: string, name: string) => JSON.parse(readFileSync(path.join(inputs, folder, name), "utf8")) as T;
const address = (folder: string) => pathToFileURL(path.resolve(inputs, folder, "report.html")).href;

test.skip(inputs === "", "POSEMIX_REPORT_INPUTS is not set: make report-test sets it");

for (const [folder, kind] of [["slam", "slam"], ["joint", "slam"], ["moving", "slam"], ["mixture", "mixture"], ["salt-box", "salt_box"], ["study", "study"], ["consistency", "consistency"]]) {
  test(`the program's report of ${folder} loads without complaints, all tabs`, async ({ page }) => {
    const complaints = watch(page);
    await page.goto(address(folder));
    await page.waitForSelector("html[data-ready]");
    await expect(page.getByRole("alert")).toHaveCount(0);
    expect(await probe(page, "kind")).toBe(kind);
    await openAllTabs(page);
    expect(complaints).toEqual([]);
  });
}

/** Every number of a document, by its path. */
function numbers(document: JsonObject): [string, unknown][] {
  return Object.entries(document).flatMap(([key, value]): [string, unknown][] =>
    value !== null && typeof value === "object" ? numbers(value as JsonObject).map(([path, number]) => [`${key}/${path}`, number]) : [[key, value]]);
}

for (const folder of ["slam", "joint", "moving"]) {
  test(`the program's report of ${folder} shows its trace`, async ({ page }) => {
    const trace = json<TraceJson>(folder, "trace.json");
    await page.goto(address(folder));
    await page.waitForSelector("html[data-ready]");
    expect(await probe(page, "frames")).toBe(trace.frames);
    for (const frame of [0, 1, 77, trace.frames - 1]) {
      await scrub(page, frame);
      for (const [id, pose] of [["camera", trace.camera.pose[frame]], ...trace.order.map((name) => [name, trace.objects[name].world.pose[frame]])] as [string, number[] | null][]) {
        const shown = await shownPose(page, id);
        expect(shown === undefined, `${id} at ${frame}`).toBe(pose === null);
        pose?.slice(0, 3).forEach((value, i) => expect(Math.abs(shown!.position[i] - value)).toBeLessThan(0.51e-5));
        const dot = pose?.slice(3).reduce((sum, value, i) => sum + value * shown!.quaternion[i], 0) ?? 1;
        expect(1 - Math.abs(dot)).toBeLessThan(1e-8);
      }
    }
    expect(await probe<number>(page, "ellipsoids")).toBe(1 + trace.order.filter((id) => trace.objects[id].world.pose[trace.frames - 1]).length);
  });

  test(`the program's report of ${folder} shows its metrics.json`, async ({ page }) => {
    const metrics = json<{ objects: Record<string, JsonObject>; camera: JsonObject }>(folder, "metrics.json");
    await page.goto(address(folder));
    await page.getByRole("tab", { name: "Numbers" }).click();
    const value = (key: string) => page.locator(`#metrics [data-key="${key}"]`).getAttribute("data-value");
    // What is null in all rows has no column.
    const known = Object.entries(metrics.camera).filter(([, number]) => number !== null);
    for (const [name, number] of known) expect(JSON.parse((await value(`camera/${name}`))!)).toBe(number);
    for (const [id, object] of Object.entries(metrics.objects)) {
      for (const [name, number] of numbers(object).filter(([, number]) => number !== null)) expect(JSON.parse((await value(`objects/${id}/${name}`))!)).toBe(number);
    }
  });
}

test("the program's tracks are shown where objects move, and not elsewhere", async ({ page }) => {
  const trace = json<TraceJson>("moving", "trace.json");
  await page.goto(address("moving"));
  await page.waitForSelector("html[data-ready]");
  await page.getByRole("tab", { name: "Tracks" }).click();
  const moving = trace.order.filter((id) => trace.objects[id].model_names);
  for (const id of moving) await expect(page.getByText(`models of motion of ${id}`)).toBeVisible();
  expect(moving.length).toBeGreaterThan(0);
  for (const frame of [10, 150, trace.frames - 1]) {
    await scrub(page, frame);
    for (const id of trace.order) {
      const again = trace.objects[id].register_again![frame] ? ", register again" : "";
      await expect(page.locator("#state tr", { hasText: id }).locator("td").last()).toHaveText(trace.objects[id].health![frame] + again);
    }
  }
  await page.goto(address("joint"));
  await page.waitForSelector("html[data-ready]");
  await expect(page.getByRole("tab", { name: "Tracks" })).toHaveCount(0);
});

test("the program's meshes are drawn", async ({ page }) => {
  await page.goto(address("slam"));
  await page.waitForSelector("html[data-ready]");
  expect(await probe(page, "bodies")).toEqual(["tea-box"]);
});

test("the program's salt box has its stages in space, in their order", async ({ page }) => {
  await page.goto(address("salt-box"));
  await page.waitForSelector("html[data-ready]");
  const rows = json<{ rows: { stage: string }[] }>("salt-box", "study.json").rows.map(({ stage }) => `mixture_${stage}.json`);
  expect((await probe<string[]>(page, "mixtures")).slice(0, rows.length)).toEqual(rows);
});

test("every folder of the inputs is looked at", () => {
  const reports = readdirSync(inputs, { withFileTypes: true }).filter((entry) => entry.isDirectory() && readdirSync(path.join(inputs, entry.name)).includes("report.html"));
  expect(reports.map(({ name }) => name).sort()).toEqual(["consistency", "joint", "mixture", "moving", "salt-box", "slam", "study"]);
});
