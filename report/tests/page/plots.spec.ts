// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What one can do with the plots: legend, zoom, export, selection.
import { readFileSync } from "node:fs";
import { expect, type Locator, type Page, test } from "@playwright/test";
import { riverReport, riverTrace, STEP_S } from "../river_trace.ts";
import { syntheticReport } from "../synthetic.ts";
import { boxOf, open, openAllTabs, probe, scrub } from "./report.ts";

const panel = (page: Page) => page.locator("[role=tabpanel]:not([hidden])");
const chart = (page: Page, title: string): Locator => panel(page).locator(".chart", { has: page.locator("figcaption", { hasText: title }) }).first();

async function openTab(page: Page, name: string): Promise<void> {
  await page.getByRole("tab", { name, exact: true }).click();
}

/** Presses at shares of the width and height of a plot. */
async function press(plot: Locator, x: number, y: number): Promise<void> {
  const over = plot.locator(".u-over");
  await over.scrollIntoViewIfNeeded();
  const box = await boxOf(over);
  await over.click({ position: { x: x * box.width, y: y * box.height } });
}

async function saved(page: Page, plot: Locator, kind: string): Promise<string> {
  await plot.locator("summary").click();
  const [file] = await Promise.all([page.waitForEvent("download"), plot.getByRole("button", { name: kind, exact: true }).click()]);
  return (await file.path())!;
}

test("captions have the error at the playhead, and the one under the pointer while it is there", async ({ page }) => {
  const trace = riverTrace();
  await open(page, "plots-values", riverReport(trace));
  await openTab(page, "Errors");
  await page.getByRole("combobox", { name: "Pose of" }).selectOption("camera");
  const value = chart(page, "position y [mm]").locator('.readout [data-label="error"]');
  const error = (frame: number) => 1000 * (trace.camera.truth![frame]![1] - trace.camera.pose[frame]![1]);
  const shown = async () => Number((await value.textContent())!.replace("error ", ""));
  for (const frame of [0, 17, 399]) {
    await scrub(page, frame);
    expect(Math.abs((await shown()) - error(frame))).toBeLessThan(0.02);
  }
  await expect(panel(page).locator(".when").first()).toHaveText(`playhead at ${(399 * STEP_S).toFixed(2)} s`);
  const over = chart(page, "position y [mm]").locator(".u-over");
  await over.scrollIntoViewIfNeeded();
  const box = await boxOf(over);
  await page.mouse.move(box.x + box.width / 2, box.y + 20);
  const seconds = Number((await panel(page).locator(".when").first().textContent())!.match(/^pointer at ([\d.]+) s$/)![1]);
  expect(Math.abs((await shown()) - error(Math.round(seconds / STEP_S)))).toBeLessThan(0.02);
  await page.mouse.move(0, 0);
  await expect(panel(page).locator(".when").first()).toContainText("playhead");
  expect(Math.abs((await shown()) - error(399))).toBeLessThan(0.02);
});

test("the legend is one, its entries are buttons that switch series, and stay so for another object", async ({ page }) => {
  await open(page, "plots-legend", riverReport());
  await openTab(page, "Errors");
  const legend = panel(page).locator(".plot-legend").first();
  await expect(legend.locator(".entry")).toHaveText(["99.7 % bound", "detected", "error", "outside", "3 sigma", "1 sigma"]);
  await expect(panel(page).getByText("(lower)")).toHaveCount(0);
  const entry = legend.getByRole("button", { name: "detected" });
  const picture = chart(page, "rotation error").locator("canvas");
  const before = await picture.screenshot();
  await entry.focus();
  await page.keyboard.press("Enter");
  await expect(entry).toHaveAttribute("aria-pressed", "false");
  expect((await picture.screenshot()).equals(before)).toBe(false);
  await expect(chart(page, "rotation error").locator('[data-label="detected"]')).toHaveText("");
  await page.getByRole("combobox", { name: "Pose of" }).selectOption("box");
  await expect(legend.getByRole("button", { name: "detected" })).toHaveAttribute("aria-pressed", "false");
  await legend.getByRole("button", { name: "detected" }).click();
  await expect(chart(page, "rotation error").locator('[data-label="detected"]')).toHaveText(/^detected \d/);
});

test("a drag zooms all plots of the time, the playhead out of view is told, and reset shows all", async ({ page }) => {
  await open(page, "plots-zoom", riverReport());
  await openTab(page, "Errors");
  await scrub(page, 390);
  const over = chart(page, "position error").locator(".u-over");
  await over.scrollIntoViewIfNeeded();
  const box = await boxOf(over);
  await page.mouse.move(box.x + 0.25 * box.width, box.y + 30);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.5 * box.width, box.y + 30, { steps: 4 });
  await page.mouse.up();
  await expect(panel(page).getByText("The playhead, at 195 s, is out of view.")).toBeVisible();
  for (const title of ["position error", "rotation about z"]) await expect(chart(page, title).locator(".off")).toHaveText("195 ▸");
  expect(await probe(page, "frame")).toBe(390);
  // The press at the middle of what is shown, a quarter to a half of 199.5 s, is at three eighths.
  await press(chart(page, "position x"), 0.5, 0.5);
  expect(Math.abs((await probe<number>(page, "frame")) - 0.375 * 399)).toBeLessThan(5);
  await openTab(page, "Hypotheses");
  const reset = panel(page).getByRole("button", { name: "Reset zoom" }).first();
  await expect(reset).toBeVisible();
  await reset.click();
  await expect(panel(page).getByRole("button", { name: "Reset zoom" })).toHaveCount(0);
  await panel(page).getByRole("button", { name: "Zoom in" }).first().press("Enter");
  await openTab(page, "Errors");
  await expect(panel(page).getByRole("button", { name: "Reset zoom" }).first()).toBeVisible();
  await over.dblclick();
  await expect(panel(page).getByRole("button", { name: "Reset zoom" })).toHaveCount(0);
});

test("CSV has the drawn numbers of the trace, over the shown part", async ({ page }) => {
  const trace = riverTrace();
  await open(page, "plots-csv", riverReport(trace));
  await openTab(page, "Errors");
  await page.getByRole("combobox", { name: "Pose of" }).selectOption("camera");
  const lines = readFileSync(await saved(page, chart(page, "position x [mm]"), "CSV"), "utf8").trim().split("\n").map((line) => line.split(","));
  expect(lines[0]).toEqual(["time [s]", "3 sigma high", "3 sigma low", "1 sigma high", "1 sigma low", "error", "outside"]);
  expect(lines.length).toBe(401);
  for (const frame of [0, 123, 399]) {
    const [seconds, high, low, , , error] = lines[frame + 1].map(Number);
    expect(seconds).toBe(frame * STEP_S);
    expect(Math.abs(high - 6)).toBeLessThan(0.01);
    expect(low).toBe(-high);
    expect(Math.abs(error - 1000 * (trace.camera.truth![frame]![0] - trace.camera.pose[frame]![0]))).toBeLessThan(0.02);
  }
  await panel(page).getByRole("button", { name: "Zoom in" }).first().click();
  const part = readFileSync(await saved(page, chart(page, "position x [mm]"), "CSV"), "utf8").trim().split("\n");
  expect(Math.abs(part.length - 201)).toBeLessThan(3);
});

test("SVG is drawn from the series and PNG is a picture of it, of every plot of every tab", async ({ page }) => {
  test.setTimeout(120_000);
  const complaints = await open(page, "plots-svg", riverReport());
  for (const [tab, title] of [["Errors", "position y"], ["Consistency", "NEES"], ["Hypotheses", "hypotheses of cup"], ["Status", "status of"], ["Detections", "NIS"]]) {
    await openTab(page, tab);
    const text = readFileSync(await saved(page, chart(page, title), "SVG"), "utf8");
    const drawn = await page.evaluate((svg) => {
      const made = new DOMParser().parseFromString(svg, "image/svg+xml");
      return { name: made.documentElement.nodeName, title: made.querySelector("title")?.textContent, shapes: made.querySelectorAll("svg svg *").length, images: made.querySelectorAll("image, foreignObject, script").length };
    }, text);
    expect(drawn.name, tab).toBe("svg");
    expect(drawn.title, tab).toContain(title);
    expect(drawn.shapes, tab).toBeGreaterThan(2);
    expect(drawn.images, tab).toBe(0);
  }
  const png = readFileSync(await saved(page, chart(page, "NIS"), "PNG"));
  expect(png.subarray(1, 4).toString()).toBe("PNG");
  expect(png.readUInt32BE(16)).toBe(1280);
  expect(png.length).toBeGreaterThan(5000);
  expect(complaints).toEqual([]);
});

test("the menu works by keys, and Escape closes it", async ({ page }) => {
  await open(page, "plots-menu", riverReport());
  await openTab(page, "Detections");
  const first = panel(page).locator(".chart").first();
  await first.locator("summary").focus();
  await page.keyboard.press("Enter");
  await page.keyboard.press("Tab");
  await expect(first.getByRole("button", { name: "PNG" })).toBeFocused();
  await page.keyboard.press("Escape");
  await expect(first.locator("details")).not.toHaveAttribute("open");
  await expect(first.locator("summary")).toBeFocused();
});

test("a row of the status chart selects its object and time; the table does by keys", async ({ page }) => {
  await open(page, "plots-status", riverReport());
  await openTab(page, "Status");
  expect(await probe(page, "selected")).toBe("cup");
  await press(chart(page, "status"), 0.5, 0.25);
  expect(await probe(page, "selected")).toBe("box");
  expect(Math.abs((await probe<number>(page, "frame")) - 199.5)).toBeLessThan(4);
  await expect(panel(page).locator("tr.highlighted th")).toHaveText("box");
  await press(chart(page, "status"), 0.5, 0.75);
  expect(await probe(page, "selected")).toBe("cup");
  await panel(page).getByRole("button", { name: "box" }).press("Enter");
  expect(await probe(page, "selected")).toBe("box");
  // The legend has what occurs, the table counts it: of 400 frames every fifth has no detection.
  await expect(panel(page).locator(".legend li")).toHaveText([/^started/, /^used/, /^gated/]);
  await expect(panel(page).locator("tr", { hasText: "cup" }).locator("td")).toHaveText(["80", "1", "318", "1"]);
});


test("errors beyond the edge are counted and marked, and can be seen whole", async ({ page }) => {
  const trace = riverTrace();
  for (const frame of [50, 51, 300]) trace.camera.truth![frame]![0] += 5;
  await open(page, "plots-beyond", riverReport(trace));
  await openTab(page, "Errors");
  await page.getByRole("combobox", { name: "Pose of" }).selectOption("camera");
  const plot = chart(page, "position x [mm]");
  await expect(plot.locator(".beyond")).toHaveText("error: 3 frames beyond");
  await expect(plot.locator(".note")).toContainText("but for 3 frames beyond 6 sigma");
  // The shown range is that of the other frames: 2 mm are seen.
  const svg = readFileSync(await saved(page, plot, "SVG"), "utf8");
  expect(svg.match(/<polygon points="[^"]*" fill="#[0-9a-f]+"\/>/gi)!.length).toBeGreaterThanOrEqual(2);
  await page.getByRole("checkbox", { name: "Whole range" }).check();
  await expect(plot.locator(".beyond")).toHaveText("");
  await page.getByRole("checkbox", { name: "Whole range" }).uncheck();
  // Zoomed to the end of the run nothing is beyond.
  await scrub(page, 390);
  for (let i = 0; i < 4; ++i) await panel(page).getByRole("button", { name: "Zoom in" }).first().click();
  await expect(plot.locator(".beyond")).toHaveText("");
});

test("plots are figures with a name; the picture has a text, the controls around it stay reachable, and touch scrolls", async ({ page }) => {
  const complaints = await open(page, "plots-names", syntheticReport({ frames: 60, objects: 2, hypotheses: 2 }));
  await openAllTabs(page);
  await openTab(page, "Errors");
  for (const figure of await panel(page).locator(".chart").all()) {
    await expect(figure).toHaveRole("figure");
    await expect(figure.locator("canvas")).toHaveAccessibleName(/^Plot of .+: .+ points/);
    await expect(figure.locator("summary")).toHaveAccessibleName(/^Save plot: /);
    expect(await figure.locator("[role=img] *").count()).toBe(0);
    expect(await figure.locator(".u-over").evaluate((node) => getComputedStyle(node).touchAction)).toBe("auto");
  }
  expect(complaints).toEqual([]);
});
