// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { readFileSync } from "node:fs";
import { expect, type Page, test } from "@playwright/test";
import type { JsonObject } from "../../src/payload.ts";
import { parseCsv } from "../../src/ui/csv.ts";
import { grasp, monteCarlo, noise, unknownStudy, ycbv } from "../study_documents.ts";
import { boxOf, open, openAllTabs } from "./report.ts";

test.setTimeout(120_000);

/** Group, x, value and number of rows of every point that is drawn. */
async function drawn(page: Page): Promise<{ group: string; x: string; value: number; rows: number }[]> {
  // A chart is drawn once it knows its width.
  await page.locator(".table-chart [data-value]").first().waitFor({ state: "attached" });
  return page.locator(".table-chart [data-value]").evaluateAll((marks) => marks.map((mark) => ({
    group: mark.getAttribute("data-group")!, x: mark.getAttribute("data-x")!, value: Number(mark.getAttribute("data-value")), rows: Number(mark.getAttribute("data-rows")),
  })));
}

const pick = (page: Page, name: string, label: string) => page.getByRole("combobox", { name, exact: true }).selectOption({ label });

test("a study opens with its result, and says where it comes from", async ({ page }) => {
  const complaints = await open(page, "story", monteCarlo());
  await expect(page.getByRole("region", { name: "Result" })).toContainText("iterated has the smallest rotation error of the camera, 9.99 deg; midway follows with 10 deg: a tie, 0.01 deg apart on the same 400 runs, p = 0.4");
  await expect(page.locator(".subtitle").first()).not.toHaveText("Study monte-carlo");
  await page.getByText("posemix 0.2.0 · seed 7 · 2026-03-01 12:00 UTC").click();
  await expect(page.getByText("posemix study monte-carlo --out 'out dir/x'")).toBeVisible();
  await expect(page.getByText("path.turns")).toBeVisible();
  await expect(page.getByText("cafe0123")).toBeVisible();
  expect(complaints).toEqual([]);
});

test("a study of unknown columns has no invented result", async ({ page }) => {
  await open(page, "story-unknown", unknownStudy());
  await expect(page.getByRole("region", { name: "Result" })).toHaveCount(0);
  await openAllTabs(page);
});

test("units have panels of their own, and points say what they are means of", async ({ page }) => {
  await open(page, "chart-units", noise(0));
  await expect(page.locator("figcaption")).toHaveText(["robust standard deviation [deg], by object", "robust standard deviation [mm], by object"]);
  await expect(page.locator(".notes")).toContainText("Each point is the mean of 2 rows, over detector; bars are one standard error of that mean.");
  await expect(page.locator(".notes")).toContainText("Left out: 8 rows whose object is all.");
  expect((await drawn(page)).find(({ group, x }) => group === "rotation_x" && x === "mug")).toEqual({ group: "rotation_x", x: "mug", value: 2.5, rows: 2 });
  await pick(page, "Only detector", "cosypose");
  await expect(page.locator(".notes")).toContainText("Each point is one row.");
  expect((await drawn(page)).find(({ group, x }) => group === "rotation_x" && x === "mug")).toEqual({ group: "rotation_x", x: "mug", value: 3, rows: 1 });
  await page.getByRole("checkbox", { name: "Rows of all, mean, median" }).check();
  expect((await drawn(page)).some(({ x }) => x === "all")).toBe(true);
  // Names are no numbers: no line joins them.
  await expect(page.locator(".table-chart .curve")).toHaveCount(0);
});

test("a study's own totals stand for what is not drawn", async ({ page }) => {
  await open(page, "chart-totals", grasp());
  await expect(page.getByRole("combobox", { name: "Only split", exact: true })).toHaveValue("all");
  expect((await drawn(page)).every(({ rows }) => rows === 1)).toBe(true);
  await pick(page, "Only split", "every");
  await expect(page.locator(".notes")).toContainText("mean of 2 rows, over split");
});

test("too many groups are cut with a word, or have a panel each", async ({ page }) => {
  await open(page, "chart-groups", ycbv(19));
  expect(new Set((await drawn(page)).map(({ x }) => x)).size).toBe(19);
  await pick(page, "Group by", "method");
  await pick(page, "Against", "sequence");
  await expect(page.locator(".notes")).toContainText("14 of 19 groups are shown");
  expect(new Set((await drawn(page)).map(({ group }) => group)).size).toBe(14);
  await page.getByRole("checkbox", { name: "A panel per group" }).check();
  await expect(page.locator(".table-chart")).toHaveCount(19);
  await expect(page.locator(".notes")).not.toContainText("groups are shown");
});

test("tables sort, narrow, go on, and are saved as they are shown", async ({ page }) => {
  await open(page, "tables", ycbv(60));
  await page.getByRole("tab", { name: "Tables" }).click();
  const rows = page.locator(".data-table").filter({ has: page.getByRole("heading", { name: "rows", exact: true }) });
  const column = (name: string) => rows.locator(`tbody [data-key$="/${name}"]`).evaluateAll((cells) => cells.map((cell) => JSON.parse(cell.getAttribute("data-value")!) as unknown));
  await expect(rows.getByRole("status")).toHaveText("240 rows; 1 to 100 are shown");
  await rows.getByRole("button", { name: "pixel median" }).click();
  await expect(rows.getByRole("columnheader", { name: "pixel median" })).toHaveAttribute("aria-sort", "descending");
  const falling = (await column("pixel_median")) as number[];
  expect(falling).toEqual([...falling].sort((a, b) => b - a));
  await rows.getByRole("button", { name: "Next rows" }).click();
  await expect(rows.getByRole("status")).toHaveText("240 rows; 101 to 200 are shown");
  await rows.getByRole("searchbox").fill("method_07 0022");
  await expect(rows.getByRole("status")).toHaveText("1 of 240 rows");
  expect(await column("sequence")).toEqual(["0022"]);
  await rows.getByRole("searchbox").fill("");
  await rows.getByRole("combobox", { name: "sequence", exact: true }).selectOption("0004");
  await expect(rows.getByRole("status")).toHaveText("60 of 240 rows");
  const [saved] = await Promise.all([page.waitForEvent("download"), rows.getByRole("button", { name: "Save CSV of rows" }).click()]);
  expect(saved.suggestedFilename()).toBe("rows.csv");
  const table = parseCsv(readFileSync((await saved.path())!, "utf8"));
  expect(table.rows.length).toBe(60);
  expect(table.rows.map((row) => row[table.columns.indexOf("pixel_median")])).toEqual(await column("pixel_median"));
});

test("the noise of detectors: rows of lengths are in mm in table and chart, the file's own values stay", async ({ page }) => {
  await open(page, "noise-units", noise());
  await expect(page.locator(".drawn-table").nth(1)).toContainText("[mm]");
  await page.getByRole("tab", { name: "Tables" }).click();
  const table = page.locator(".data-table").first();
  await table.getByRole("combobox", { name: "unit", exact: true }).selectOption("mm");
  const cells = table.locator('tbody [data-key$="/robust_sd"]');
  const read = await cells.evaluateAll((nodes) => nodes.map((node) => [Number(node.textContent), JSON.parse((node as HTMLElement).dataset["value"]!) as number]));
  expect(read.length).toBeGreaterThan(0);
  for (const [written, value] of read) expect(Math.abs(written - 1000 * value)).toBeLessThan(0.01 * written);
  const [saved] = await Promise.all([page.waitForEvent("download"), table.getByRole("button", { name: "Save CSV of rows" }).click()]);
  const { columns, rows } = parseCsv(readFileSync((await saved.path())!, "utf8"));
  expect(rows.map((row) => row[columns.indexOf("unit")])).toEqual(read.map(() => "m"));
  expect(rows.map((row) => row[columns.indexOf("robust_sd")])).toEqual(read.map(([, value]) => value));
});

test("columns of one unit have the same decimals, and lengths are in mm beside the file's own values", async ({ page }) => {
  const report = unknownStudy();
  const study = (report["documents"] as Record<string, JsonObject>)["study.json"];
  study["rows"] = [{ stage: "one", x_m: 0.01, y_m: 0.0123, z_cm: 3 }, { stage: "two", x_m: 0.02, y_m: 0.0456, z_cm: 1 }];
  await open(page, "tables-units", report);
  await page.getByRole("tab", { name: "Tables" }).click();
  const table = page.locator(".data-table").first();
  await expect(table.getByRole("columnheader")).toHaveText(["stage", "x [mm]", "y [mm]", "z [mm]"]);
  const cells = await table.locator("tbody tr").first().locator("td").allTextContents();
  expect(cells.map(Number)).toEqual([10, 12.3, 30]);
  expect(new Set(cells.map((text) => text.split(".")[1]?.length ?? 0)).size).toBe(1);
  await expect(table.locator('[data-key="rows/0/x_m"]')).toHaveAttribute("data-value", "0.01");
});

test("where rows are different quantities their numbers share decimals by row", async ({ page }) => {
  const report = unknownStudy();
  (report["documents"] as Record<string, JsonObject>)["study.json"]["rows"] = [
    { figure: "scenes", declared: 10, none: 10 }, { figure: "share found", declared: 0.9158, none: 0.9126 }, { figure: "rotation", declared: 1.635, none: 10.17 },
  ];
  await open(page, "tables-figures", report);
  await page.getByRole("tab", { name: "Tables" }).click();
  const texts = await page.locator(".data-table").first().locator("tbody tr").evaluateAll((rows) => rows.map((row) => [...row.querySelectorAll("td")].map((cell) => cell.textContent)));
  expect(texts[0]).toEqual(["10", "10"]);
  for (const row of texts) expect(new Set(row.map((text) => text.split(".")[1]?.length ?? 0)).size).toBe(1);
});

test("the head of a table stays in view, and a row leads to its run", async ({ page }) => {
  await open(page, "tables-head", ycbv(60));
  await page.getByRole("tab", { name: "Tables" }).click();
  const region = page.getByRole("region", { name: "Table rows" });
  const head = region.locator("thead th").first();
  await region.evaluate((node) => (node.scrollTop = 1500));
  const [top, box] = await Promise.all([head.evaluate((node) => node.getBoundingClientRect().top), region.evaluate((node) => node.getBoundingClientRect().top)]);
  expect(Math.abs(top - box)).toBeLessThan(3);
  await expect(region.getByRole("link", { name: "open the run" }).first()).toHaveAttribute("href", "runs/0001_003_method_00/report.html");
});

test("rows open the page of their run, by pointer and by keyboard, and however they are sorted", async ({ page }) => {
  const path = "runs/0004_003_method_01/report.html";
  await open(page, path.replace(".html", ""), unknownStudy());
  await page.setViewportSize({ width: 390, height: 844 });
  await open(page, "tables-runs", ycbv(3));
  await page.getByRole("tab", { name: "Tables" }).click();
  const rows = page.getByRole("region", { name: "Table rows" });
  const link = rows.getByRole("link", { name: "open the run of 0004, 003, method_01", exact: true });
  // It is seen without scrolling, on a phone too, and is a word.
  await link.scrollIntoViewIfNeeded();
  await expect(rows).toHaveJSProperty("scrollLeft", 0);
  const [box, place] = [await boxOf(link), await boxOf(rows)];
  expect(box.x + box.width).toBeLessThan(place.x + place.width);
  await expect(link).toHaveText("open");
  await expect(rows.getByRole("link")).toHaveCount(9);
  await expect(rows).not.toContainText(".html");
  // Rows of means have no run.
  await expect(rows.locator('[data-key="rows/9/report"]')).toHaveText("");
  const table = page.locator(".data-table").filter({ has: rows });
  await expect(table.getByRole("combobox", { name: "report", exact: true })).toHaveCount(0);
  await rows.getByRole("button", { name: "pixel median" }).click();
  await table.getByRole("searchbox").fill("method_01");
  await expect(table.getByRole("status")).toHaveText("4 of 12 rows");
  await expect(rows.getByRole("link")).toHaveCount(3);
  const links = await rows.locator("tbody tr", { has: page.getByRole("link") }).evaluateAll((lines) => lines.map((line) => [line.querySelector("th")!.textContent, line.querySelector("a")!.getAttribute("href")]));
  for (const [sequence, to] of links) expect(to).toBe(`runs/${sequence}_003_method_01/report.html`);
  const [saved] = await Promise.all([page.waitForEvent("download"), table.getByRole("button", { name: "Save CSV of rows" }).click()]);
  const { columns, rows: lines } = parseCsv(readFileSync((await saved.path())!, "utf8"));
  expect(columns[columns.length - 1]).toBe("report");
  expect(lines.map((line) => line[columns.length - 1])).toContain(path);
  // What is seen is searched, and that is not the path.
  await table.getByRole("searchbox").fill("html");
  await expect(table.getByRole("status")).toHaveText("0 of 12 rows");
  await table.getByRole("searchbox").fill("0004 method_01");
  await link.click();
  await expect(page).toHaveURL(new RegExp(`/${path}$`));
  await page.goBack();
  await expect(page.getByRole("tab", { name: "Tables" })).toHaveAttribute("aria-selected", "true");
  await rows.focus();
  while (!(await link.evaluate((node) => node === document.activeElement))) await page.keyboard.press("Tab");
  await page.keyboard.press("Enter");
  await expect(page).toHaveURL(new RegExp(`/${path}$`));
});

test("pages of runs are nothing to draw against or to group by, and are not printed", async ({ page }) => {
  const report = ycbv(3);
  delete (report["documents"] as Record<string, JsonObject>)["study.json"]["summary"];
  await open(page, "tables-runs-print", report);
  for (const name of ["Group by", "Against"]) expect(await page.getByRole("combobox", { name }).locator("option").allTextContents()).not.toContain("report");
  await page.emulateMedia({ media: "print" });
  await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
  const heads = await page.locator("table:visible thead th").allTextContents();
  expect(heads.join()).toContain("method");
  expect(heads.join()).not.toContain("report");
});

test("many figures have an index, which words narrow; alt texts say what is shown", async ({ page }) => {
  await open(page, "figures", noise(75));
  await page.getByRole("tab", { name: "Figures" }).click();
  await expect(page.getByRole("img")).toHaveCount(1);
  await expect(page.getByRole("img", { name: "Residuals of dope for object 0" })).toBeVisible();
  await page.getByRole("searchbox", { name: "Figures with the words" }).fill("object 7");
  await expect(page.getByRole("tabpanel", { name: "Figures" }).getByRole("status")).toHaveText("12 of 75 figures");
  await page.getByRole("button", { name: "Next figure" }).click();
  await expect(page.getByRole("img", { name: "Residuals of dope for object 7. With time [s]." })).toBeVisible();
});

for (const [width, height] of [[390, 844], [1024, 768], [1366, 768], [3840, 2160]] as const) {
  test(`nothing sticks out at ${width}x${height}, and the width is used`, async ({ page }) => {
    await page.setViewportSize({ width, height });
    await open(page, `form-${width}`, ycbv(19));
    for (const tab of await page.getByRole("tab").all()) {
      await tab.click();
      expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(width);
    }
    expect((await boxOf(page.locator(".page"))).width).toBeGreaterThan(0.95 * width);
    if (width === 3840) expect(await page.evaluate(() => parseFloat(getComputedStyle(document.body).fontSize))).toBeGreaterThan(18);
  });
}
