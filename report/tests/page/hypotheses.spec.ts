// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Hypotheses over time: the river, the table at the playhead, and the mode probability of every object.
import { expect, type Page, test } from "@playwright/test";
import { hypothesesAt, MERGED, riverReport, riverTrace, STEP_S, TURNED, WRONG } from "../river_trace.ts";
import { boxOf, open, probe, scrub } from "./report.ts";

const panel = (page: Page) => page.locator("[role=tabpanel]:not([hidden])");
const rows = (page: Page) => panel(page).locator("table.hypotheses tbody tr");

async function start(page: Page, name: string): Promise<string[]> {
  const complaints = await open(page, name, riverReport());
  await page.getByRole("tab", { name: "Hypotheses", exact: true }).click();
  return complaints;
}

test("the table at the playhead is the trace: weights, the turn from the leading one, age and support", async ({ page }) => {
  const complaints = await start(page, "river-table");
  // The most uncertain object is shown first.
  expect(await probe(page, "selected")).toBe("cup");
  for (const frame of [0, 50, WRONG.first, 120, 399]) {
    await scrub(page, frame);
    const living = hypothesesAt(frame).sort((a, b) => b.probability - a.probability);
    await expect(rows(page).locator("button")).toHaveText(living.map(({ id }) => `#${id}`));
    for (const [k, { probability }] of living.entries()) {
      await expect(rows(page).nth(k).locator("td").first()).toHaveText(`${(100 * probability).toFixed(probability > 0.975 ? 1 : 0)} %`.replace(".0", probability > 0.985 ? ".0" : ""));
    }
    await expect(panel(page).locator("table.hypotheses caption")).toHaveText(`Hypotheses at ${(frame * STEP_S).toFixed(2)} s; none of them 2 %`);
  }
  await scrub(page, 120);
  const cells = (k: number) => rows(page).nth(k).locator("td");
  await expect(cells(0)).toHaveText(["63 %", "leading", "", "", `${(120 * STEP_S).toFixed(1)} s`, /./, ""]);
  await expect(cells(1)).toHaveText(["25 %", /^(180\.0|179\.9) deg$/, "z", "10.0 mm", `${((120 - TURNED.first) * STEP_S).toFixed(1)} s`, /./, ""]);
  await expect(cells(2)).toHaveText(["10 %", "5.7 deg", "z", "30.0 mm", `${((120 - MERGED.first) * STEP_S).toFixed(1)} s`, /./, ""]);
  await scrub(page, MERGED.last);
  await expect(cells(2).last()).toHaveText("merges into #3");
  await scrub(page, TURNED.last);
  await expect(cells(1).last()).toHaveText("is dropped");
  expect(complaints).toEqual([]);
});

test("pointing at a band or a row highlights the hypothesis in both, and a press goes to the time", async ({ page }) => {
  await start(page, "river-hover");
  await scrub(page, 120);
  const over = panel(page).locator(".u-over").first();
  const canvas = panel(page).locator("canvas").first();
  await over.scrollIntoViewIfNeeded();
  const box = await boxOf(over);
  const at = (frame: number, weight: number) => ({ x: (box.width * frame) / 399, y: box.height * (1 - weight / 1.16) });
  const plain = await canvas.screenshot();
  await over.hover({ position: at(120, 0.75) });
  await expect(panel(page).locator("tr.highlighted button")).toHaveText(`#${TURNED.id}`);
  await page.mouse.move(0, 0);
  await expect(panel(page).locator("tr.highlighted")).toHaveCount(0);
  await rows(page).nth(1).locator("button").focus();
  await expect(panel(page).locator("tr.highlighted button")).toHaveText(`#${TURNED.id}`);
  await page.waitForTimeout(60);
  expect((await canvas.screenshot()).equals(plain)).toBe(false);
  await over.click({ position: at(250, 0.5) });
  expect(Math.abs((await probe<number>(page, "frame")) - 250)).toBeLessThan(3);
});

test("births, merges and drops are marked; the CSV has every weight", async ({ page }) => {
  await start(page, "river-csv");
  const plot = panel(page).locator(".chart").first();
  await plot.locator("summary").click();
  const [file] = await Promise.all([page.waitForEvent("download"), plot.getByRole("button", { name: "CSV" }).click()]);
  const lines = (await import("node:fs")).readFileSync((await file.path())!, "utf8").trim().split("\n").slice(1).map((line) => line.split(",").map(Number));
  const expected = Array.from({ length: 400 }, (_, frame) => hypothesesAt(frame).map(({ id, probability }) => [frame * STEP_S, id, probability])).flat();
  expect(lines.length).toBe(expected.length);
  for (const [seconds, id, weight] of expected) {
    const found = lines.find((line) => line[0] === seconds && line[1] === id);
    expect(Math.abs((found?.[2] ?? NaN) - weight)).toBeLessThan(1e-4);
  }
  await plot.locator("summary").click();
  const [svg] = await Promise.all([page.waitForEvent("download"), plot.getByRole("button", { name: "SVG" }).click()]);
  const text = (await import("node:fs")).readFileSync((await svg.path())!, "utf8");
  const shapes = [...text.matchAll(/<polygon points="([^"]+)"/g)].map((match) => match[1].split(" ").length);
  // Two births are triangles, one merge is a diamond; the one that is dropped is a cross of two lines.
  expect(shapes.filter((corners) => corners === 3).length).toBe(2);
  expect(shapes.filter((corners) => corners === 4).length).toBe(1);
  expect(text.match(/stroke-width="1\.6"/g)!.length).toBe(2);
});

test("one small plot per object for the mode probability; a press on it selects the object", async ({ page }) => {
  await start(page, "river-modes");
  const small = panel(page).locator(".chart-group.small .chart");
  await expect(small.locator("figcaption")).toHaveText([/^box/, /^cup/]);
  const cup = riverTrace().objects["cup"].mode_probability!.map((value) => value!);
  const least = cup.indexOf(Math.min(...cup));
  await expect(small.nth(1).locator(".note")).toHaveText(`lowest ${(100 * cup[least]).toFixed(0)} % at ${(least * STEP_S).toFixed(2)} s`);
  await small.first().locator(".u-over").click();
  expect(await probe(page, "selected")).toBe("box");
  await expect(panel(page).locator("table.hypotheses caption")).toHaveText("There is no hypothesis at this frame");
});
