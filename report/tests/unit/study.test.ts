// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Json, JsonObject } from "../../src/payload.ts";
import { scaleOf, tickText } from "../../src/plots/scale.ts";
import { tracePath } from "../../src/plots/time_plot.ts";
import { commandOf, factsOf, provenanceLines, settingsOf } from "../../src/pages/provenance.ts";
import { type Choice, firstFilters, pointsOf } from "../../src/study/aggregate.ts";
import { errorColumnOf, keyColumns, linkColumn, numericColumns, quantityColumns, wordColumns } from "../../src/study/columns.ts";
import { lengthScales, shownTable } from "../../src/study/shown.ts";
import { storyOf } from "../../src/study/stories.ts";
import { parseCsv, type Table, tableOfRows } from "../../src/ui/csv.ts";
import { csvOf, decimalsOf, safePath } from "../../src/ui/data_table.ts";
import { grasp, monteCarlo, noise, unknownStudy, ycbv } from "../study_documents.ts";

const document = (report: JsonObject) => (report["documents"] as Record<string, JsonObject>)["study.json"];
const rowsOf = (report: JsonObject): Table => tableOfRows(document(report)["rows"]);
const choice = (some: Partial<Choice>): Choice => ({ x: "", y: "", by: "", reduce: "mean", filters: {}, totals: false, ...some });

const table: Table = {
  columns: ["method", "level", "error"],
  rows: [["a", 1, 2], ["a", 0, 1.5], ["b", 1, 4], ["a", 1, 4], ["b", 0, null], ["mean", 1, 100]],
};

test("what may stand where in a chart", () => {
  assert.deepEqual(numericColumns(table), ["level", "error"]);
  assert.deepEqual(wordColumns(table), ["method"]);
  assert.deepEqual(keyColumns(table), ["method", "level"]);
  const rows = rowsOf(monteCarlo());
  assert.equal(errorColumnOf(rows, "robot_rotation_rmse_deg"), "robot_rotation_rmse_deg_standard_error");
  assert.ok(!quantityColumns(rows).some((name) => name.endsWith("standard_error") || name.endsWith("band_low")));
});

test("points say what they are means of, and leave totals out", () => {
  const { panels, notes, words } = pointsOf(table, choice({ x: "level", y: "error", by: "method" }));
  assert.equal(words, false);
  assert.deepEqual(panels[0].lines.map(({ group, points }) => [group, points.map(({ x, value, rows }) => [x, value, rows])]), [
    ["a", [[0, 1.5, 1], [1, 3, 2]]], ["b", [[1, 4, 1]]],
  ]);
  // The standard error of the mean of 2 and 4.
  assert.deepEqual([panels[0].lines[0].points[1].low, panels[0].lines[0].points[1].high], [2, 4]);
  assert.match(notes.join(" "), /^Each point is the mean of 1 to 2 rows; bars are one standard error of that mean\. Left out: 1 rows whose method is mean\.$/);
  const all = pointsOf(table, choice({ x: "level", y: "error", by: "method", totals: true }));
  assert.deepEqual(all.groups, ["a", "b", "mean"]);
});

test("units never share an axis", () => {
  const rows = rowsOf(noise());
  const { panels, notes } = pointsOf(rows, choice({ x: "object", y: "robust_sd", by: "axis" }));
  assert.deepEqual(panels.map(({ unit, lines }) => [unit, lines.map(({ group }) => group)]), [["deg", ["rotation_x", "rotation_y"]], ["m", ["translation_x", "translation_z"]]]);
  assert.match(notes[0], /mean of 2 rows, over detector/);
  const mixed: Table = { columns: ["figure", "declared"], rows: [["rotation_deg", 2], ["translation_m", 0.1], ["within_share", 0.8]] };
  assert.deepEqual(pointsOf(mixed, choice({ x: "figure", y: "declared" })).panels.map(({ unit }) => unit), ["deg", "m", "share"]);
});

test("the table's own standard errors are the bars of single rows", () => {
  const { panels, notes } = pointsOf(rowsOf(monteCarlo()), choice({ x: "noise_exponent", y: "robot_rotation_rmse_deg", by: "method" }));
  const last = panels[0].lines.find(({ group }) => group === "midway")!.points[5];
  assert.equal(last.rows, 1);
  assert.ok(Math.abs(last.high! - last.value - 0.077) < 1e-12);
  assert.match(notes[0], /one row; bars are one standard error/);
});

test("more groups than fit are cut to the largest and this is said; colours keep their place", () => {
  const rows = rowsOf(ycbv(19));
  const few = pointsOf(rows, choice({ x: "sequence", y: "pixel_median", by: "method" }));
  assert.equal(few.groups.length, 14);
  assert.ok(few.notes.some((text) => text.startsWith("14 of 19 groups are shown")));
  assert.equal(pointsOf(rows, choice({ x: "sequence", y: "pixel_median", by: "method" }), true).groups.length, 19);
  const one = pointsOf(rows, choice({ x: "sequence", y: "pixel_median", by: "method", filters: { method: "method_07" } }));
  assert.deepEqual(one.panels[0].lines.map(({ group, index }) => [group, index]), [["method_07", 7]]);
  assert.ok(few.panels[0].lines.every(({ points }) => points.every(({ value }) => value < 100)));
});

test("a study's own totals are taken rather than averaged on the page", () => {
  const rows = rowsOf(grasp());
  const first = choice({ x: "method", y: "brier", by: "gripper" });
  const filters = firstFilters(rows, first);
  assert.deepEqual(filters, { split: "all", object: "all" });
  const { panels, notes } = pointsOf(rows, { ...first, filters });
  assert.ok(panels[0].lines.every(({ points }) => points.every(({ rows }) => rows === 1)));
  assert.match(notes.join(" "), /Left out: \d+ rows whose gripper is all/);
});

test("a total is never averaged with what it is made of, in whichever column it stands", () => {
  const rows: Table = {
    columns: ["sequence", "object", "method", "pixels"],
    rows: ["a", "b", "c"].flatMap((sequence, s) => ["x", "y"].map((method, m): Json[] => [sequence, "mug", method, 1 + 10 * m + s ** 2]))
      .concat(["mean", "median"].flatMap((name) => ["x", "y"].map((method): Json[] => [name, "all", method, name === "mean" ? 900 : 100]))),
  };
  const first = choice({ x: "method", y: "pixels", reduce: "median" });
  const filters = firstFilters(rows, first);
  assert.deepEqual(filters, {});
  const { panels, notes } = pointsOf(rows, { ...first, filters });
  assert.deepEqual(panels[0].lines[0].points.map(({ x, value, rows }) => [x, value, rows]), [["x", 2, 3], ["y", 12, 3]]);
  assert.equal(notes[0], "Each point is the median of 3 rows, over sequence; bars are the quartiles.");
  assert.equal(notes[1], "Left out: 4 rows whose sequence is mean or median.");
  // The reader asks for the totals: the one that the chart is of, rather than something between the two.
  const total = pointsOf(rows, { ...first, filters: { object: "all" } });
  assert.deepEqual(total.panels[0].lines[0].points.map(({ value, rows }) => [value, rows]), [[100, 1], [100, 1]]);
  assert.match(total.notes.join(" "), /one row.* Only rows whose sequence is median are drawn, not those of mean\./);
  assert.deepEqual(pointsOf(rows, { ...first, filters: { sequence: "mean" } }).panels[0].lines[0].points.map(({ value }) => value), [900, 900]);
});

test("results in words, from the data alone", () => {
  const tables = (report: JsonObject) => ({ rows: rowsOf(report), ...(document(report)["summary"] ? { summary: tableOfRows(document(report)["summary"]) } : {}) });
  const story = storyOf("monte-carlo", tables(monteCarlo()));
  assert.match(story[0], /^At the noisiest odometry \(covariance times 10\^5\) iterated has the smallest rotation error of the camera, 9\.99 deg; midway follows with 10 deg \(standard errors 0\.077 and 0\.077\)\.$/);
  const paired = parseCsv((monteCarlo()["tables"] as Record<string, string>)["paired.csv"]);
  assert.match(storyOf("monte-carlo", { ...tables(monteCarlo()), "paired.csv": paired })[0], /midway follows with 10 deg: a tie, 0\.01 deg apart on the same 400 runs, p = 0\.4\.$/);
  assert.match(story[1], /covariance of iterated .*ANEES 1\.002, expected 1\); that of riekf is the farthest \(3\.314\)/);
  assert.match(storyOf("grasp", tables(grasp())).join(" "), /Over 6741 grasps mixture has the smallest Brier score, 0\.12; gaussian follows with 0\.147\. The bound/);
  assert.match(storyOf("ycbv", tables(ycbv()))[0], /^DOPE: method_00 has the smallest median pixel error, 12 px; method_01 follows with 13 px/);
  assert.match(storyOf("noise", tables(noise()))[0], /in 2 of 16 distributions; the heaviest is rotation_x of mug by dope, 9\.5/);
  assert.deepEqual(storyOf("of the moon", tables(unknownStudy())), []);
  assert.deepEqual(storyOf("monte-carlo", { rows: { columns: ["a"], rows: [[1]] } }), []);
  assert.deepEqual(storyOf("toString", {}), []);
});

test("the figures of the study of views have the names that the program writes", () => {
  const summary: Table = {
    columns: ["figure", "unit", "declared", "none"],
    rows: [["estimate: share within 20 deg and 5 cm", "", 0.8187, 0.7991], ["detection: share within 20 deg and 5 cm", "", 0.4503, 0.4503], ["share of steps with a flip", "", 0, 0.01066]],
  };
  assert.deepEqual(storyOf("tless", { summary }), [
    "The map has 82 % of the views of instances within 20 deg and 5 cm; single detections have 45 %.",
    "Without declared symmetries the map has 80 %; estimates flip in 0 % of the steps with them and in 1.1 % without.",
  ]);
  assert.deepEqual(storyOf("tless", { summary: { columns: ["figure"], rows: [["scenes"]] } }), []);
});

test("what is equal in the digits that are shown is a tie, and few runs rank no method", () => {
  const of = (second: number): Table => ({ columns: ["phi_deg", "rule", "kl"], rows: [[90, "midway", 1.53301], [90, "moment_matched", second], [90, "anchor", 4]] });
  assert.deepEqual(storyOf("divergence", { rows: of(1.53303) }), ["midway and moment_matched lose the least: at 90 deg between the means the KL divergence of each is 1.533 nats, a tie."]);
  assert.match(storyOf("divergence", { rows: of(1.6) })[0], /^midway loses the least: .* moment_matched follows with 1\.6\./);
  const rows = rowsOf(monteCarlo());
  const few = { columns: rows.columns, rows: rows.rows.map((row) => row.map((value, k) => (rows.columns[k] === "runs" ? 4 : value))) };
  assert.equal(storyOf("monte-carlo", { rows: few })[1], "ANEES is between 1.002 and 3.314 there (expected 1); 4 runs are too few to rank the methods by it.");
  const pixels: Table = { columns: ["detector", "method", "rows", "pixel_median"], rows: [["DOPE", "a", 3, 12.00001], ["DOPE", "b", 3, 12.00002]] };
  assert.match(storyOf("ycbv", { summary: pixels })[0], /a and b have the same median pixel error, 12 px: a tie/);
});

test("links go below the page's folder and nowhere else", () => {
  assert.equal(safePath("runs/0001 a/report.html"), "runs/0001%20a/report.html");
  for (const bad of ["../x.html", "a/../../x", "/etc/x", "javascript:alert(1)", "https://a.b/c", "//a.b", "a\\b", "", "a?b", 3, null]) assert.equal(safePath(bad), undefined, String(bad));
});

test("a column of pages is none of keys, and a column of other words called so is one", () => {
  const pages: Table = { columns: ["method", "report"], rows: [["a", "runs/a/report.html"], ["b", "runs/b/report.html"], ["mean", null]] };
  assert.equal(linkColumn(pages), 1);
  assert.deepEqual(keyColumns(pages), ["method"]);
  const words: Table = { columns: ["method", "report"], rows: [["a", "weekly"], ["b", "daily"]] };
  assert.equal(linkColumn(words), -1);
  assert.deepEqual(keyColumns(words), ["method", "report"]);
});

test("a saved table is read as it was", () => {
  const odd: Table = { columns: ["name", "value"], rows: [['a, "b"', 1.5], ["plain", null]] };
  assert.deepEqual(parseCsv(csvOf(odd)), odd);
});

test("numbers of a column share their decimals", () => {
  assert.equal(decimalsOf([1.25, 10.5, 3]), 3);
  assert.equal(decimalsOf([1, 2, 300]), 0);
  assert.equal(decimalsOf([1e-6, 1000]), undefined);
  assert.equal(decimalsOf([0.0123, 0.0456]), 5);
});

test("small lengths are shown in mm, in whichever unit a table has them", () => {
  const mixed: Table = { columns: ["stage", "place_m", "place_m_standard_error", "size_cm", "turn_deg"], rows: [["a", 0.01, 0.002, 3, 10], ["b", null, 0.001, 1, 2]] };
  assert.deepEqual([...lengthScales(mixed)], [["place_m", 1000], ["place_m_standard_error", 1000], ["size_cm", 10]]);
  assert.deepEqual(shownTable(mixed), {
    columns: ["stage", "place_mm", "place_mm_standard_error", "size_mm", "turn_deg"], rows: [["a", 10, 2, 30, 10], ["b", null, 1, 10, 2]],
  });
  // Craters are not.
  const craters = rowsOf(unknownStudy());
  assert.equal(shownTable(craters), craters);
});

test("lengths whose unit is in their row are shown in mm, what has none is as it was", () => {
  const columns = ["axis", "unit", "count", "mean", "robust_sd", "slow_sd_error", "inlier_sd_of_recordings", "kurtosis", "lag1_autocorrelation", "window_s"];
  const table: Table = { columns, rows: [["rotation_x", "deg", 9, 0.5, 1, 0.1, null, 3, 0.9, 2], ["translation_x", "m", 9, -0.002, 0.01, 0.001, 0.004, 3, 0.9, 2], ["translation_z", "range", 9, 0.002, 0.01, 0.001, null, 3, 0.9, 2]] };
  const shown = shownTable(table);
  assert.deepEqual(shown.columns, columns);
  assert.deepEqual(shown.rows, [table.rows[0], ["translation_x", "mm", 9, -2, 10, 1, 4, 3, 0.9, 2], table.rows[2]]);
  // The distances of a map are not.
  const map: Table = { columns: ["unit", "mean"], rows: [["m", 12], ["m", 40]] };
  assert.equal(shownTable(map), map);
});

test("provenance: the command can be typed, settings have their paths", () => {
  const given: JsonObject = { program: "posemix", version: "1.2", seed: 3, started: "2026-03-01T12:00:00Z", command: ["posemix", "slam", "my file.toml", "it's"], settings: { a: { b: 1, c: [1, 2] }, d: "x" } };
  assert.equal(commandOf(given), "posemix slam 'my file.toml' 'it'\\''s'");
  assert.deepEqual(settingsOf(given["settings"]), [["a.b", "1"], ["a.c", "[1,2]"], ["d", "x"]]);
  assert.deepEqual(factsOf(given), ["posemix 1.2", "seed 3", "2026-03-01 12:00 UTC"]);
  assert.deepEqual(factsOf({ started: "never", seed: null }), []);
});

test("provenance for print: whole settings or none, and long commands end after a word", () => {
  const noise = `{"mug" = {"components" = [${"{weight = 0.6}, ".repeat(20)}]}}`;
  const lines = provenanceLines({ "metrics.json": { provenance: { command: `posemix slam ${"a.toml ".repeat(80)}`, settings: { values: { motion: "odometry", noise, gate: 0.999 } } } } });
  assert.equal(lines[2], "values.motion = odometry; values.gate = 0.999; and 1 more in the page");
  assert.ok(lines[1].endsWith("a.toml …") && lines[1].length <= 240);
});

test("scales have round ticks within their ends", () => {
  assert.deepEqual(scaleOf([0, 10]).ticks, [0, 2, 4, 6, 8, 10]);
  assert.deepEqual(scaleOf([0.002, 30], { log: true }).ticks.map(tickText), ["0.01", "0.1", "1", "10"]);
  assert.equal(scaleOf([-1, 1], { log: true }).log, false);
  assert.equal(scaleOf([5, 5]).at(5), 0.5);
});

test("a path of many frames keeps their extremes and their gaps", () => {
  const values = Array.from({ length: 1000 }, (_, i) => (i === 500 ? 99 : i >= 600 && i < 700 ? null : 0));
  const path = tracePath(values, (frame) => frame / 100, (value) => value);
  assert.ok(path.includes(" 99.0"));
  assert.equal(path.split("M").length - 1, 2);
  assert.ok(path.length < 500);
});
