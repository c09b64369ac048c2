// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import assert from "node:assert/strict";
import { test } from "node:test";
import { failuresOf, failureText, spellsOf } from "../../src/compare/failures.ts";
import { cellNote, inCommon, metricRows } from "../../src/compare/metrics.ts";
import { distinctNames, placesOf, readComparison, unionOf } from "../../src/compare/runs.ts";
import { failureSentence, verdictSentences } from "../../src/compare/verdict.ts";
import type { PackedRun } from "../../src/payload.ts";
import { comparisonReport, EQUAL, FAILING, GOOD, type RunShape } from "../comparison_documents.ts";

const read = (shapes: RunShape[]) => readComparison(comparisonReport(shapes)["runs"] as unknown as PackedRun[]);

test("one timeline of several stamps", () => {
  assert.deepEqual(unionOf([[1, 2, 3], [2.0001, 3, 4]]), [1, 2, 3, 4]);
  assert.deepEqual([...placesOf([1, 2, 3, 4], [2.0001, 3, 4])], [-1, 0, 1, 2]);
  assert.deepEqual(distinctNames(["a", "b", "a"]), ["a (1)", "b", "a (2)"]);
});

test("only frames that all runs have are compared", () => {
  assert.deepEqual(inCommon([[1, 2, null], [null, 3, 4], undefined, [null, null, null]]), { series: [[null, 2, null], [null, 3, null], undefined, undefined], frames: 1 });
});

test("spells: short ones are none, short returns end none, missing frames neither", () => {
  const seconds = Array.from({ length: 12 }, (_, i) => 0.25 * i);
  const of = (text: string) => spellsOf([...text].map((c) => (c === "?" ? undefined : c === "x")), seconds);
  assert.deepEqual(of("..xx........"), []);
  assert.deepEqual(of("..xxx......."), [{ first: 2, last: 4 }]);
  assert.deepEqual(of("..xx.xx....."), [{ first: 2, last: 6 }]);
  assert.deepEqual(of("..xxx????xxx"), [{ first: 2, last: 11 }]);
  assert.deepEqual(of("xxx...xxx..."), [{ first: 0, last: 2 }, { first: 6, last: 8 }]);
});

test("who failed, when and why", async () => {
  const comparison = await read([GOOD, EQUAL, FAILING]);
  const failures = failuresOf(comparison);
  assert.equal(failures.length, 1);
  const [failure] = failures;
  assert.equal(`${failure.run.name}: ${failureText(failure)}`, "riekf: tea-box on the wrong mode from 12.3 s on");
  assert.match(failure.why, /^turned by 180 deg about its z axis, its own 99\.7 % bound is 4\.3 deg; of 77 detections in that time 100 % are right and 0 % are used$/);
  assert.equal(failureSentence(comparison, failures), "riekf fails at tea-box; multi-object and gm-iekf do not fail.");
});

test("the best, a tie, and worse, by frame", async () => {
  const comparison = await read([GOOD, EQUAL, FAILING]);
  const rows = metricRows(comparison);
  const camera = rows.find(({ entity, quantity }) => entity === "camera in the world" && quantity === "position error, rms")!;
  assert.deepEqual(camera.cells.map(({ verdict }) => verdict).sort(), ["best", "tie", "worse"]);
  assert.equal(camera.cells[2].verdict, "worse");
  // Errors along three axes.
  [0.002, 0.002, 0.006].forEach((sd, i) => assert.ok(Math.abs(camera.cells[i].value! / (1000 * sd * Math.sqrt(3)) - 1) < 0.12));
  assert.match(cellNote(camera, camera.cells[2], ["a", "b", "c"]), /^\+6\.\d+ mm \(\+\d+ %\), p < 0\.001, \d+ independent frames$/);
  const anees = rows.find(({ entity, quantity }) => entity.startsWith("tea-box") && quantity.startsWith("ANEES"))!;
  assert.deepEqual(anees.cells.map(({ value }) => value), [1.2, 1.2, 900]);
  const sentences = verdictSentences(comparison, rows);
  assert.match(sentences[0], /^Camera in the world, position error, rms: .* are a tie; riekf has 10\.\d mm \(2\.\d times as much, p < 0\.001\)\.$/);
});

test("ANEES is best where it is nearest to one, also from below", async () => {
  const report = comparisonReport([GOOD, EQUAL]);
  const runs = report["runs"] as unknown as PackedRun[];
  [0.5, 1.3].forEach((value, i) => ((runs[i].documents["metrics.json"] as { consistency: { relative_anees: Record<string, number> } }).consistency.relative_anees["mug"] = value));
  const row = metricRows(await readComparison(runs)).find(({ entity, quantity }) => entity.startsWith("mug") && quantity.startsWith("ANEES"))!;
  assert.equal(row.best, 1);
});

test("a shorter run is compared over its frames, and the reader is told", async () => {
  const comparison = await read([GOOD, { ...EQUAL, frames: 80 }]);
  assert.match(comparison.cautions[0], /different length \(multi-object 200 frames, 0\.0 to 19\.9 s; gm-iekf 80 frames, 0\.0 to 7\.9 s\)/);
  assert.equal(metricRows(comparison)[0].frames, 80);
  assert.equal(comparison.runs[1].shown[79], 79);
  assert.equal(comparison.runs[1].shown[80], -1);
});

test("runs without truth differ, and are not judged", async () => {
  const comparison = await read([{ ...GOOD, truth: false }, { ...FAILING, truth: false }]);
  assert.ok(comparison.cautions.some((text) => text.startsWith("There is no ground truth")));
  assert.ok(metricRows(comparison).every(({ quantity, best, entity }) => entity === "program" || (best === -1 && !quantity.includes("error"))));
  assert.deepEqual(verdictSentences(comparison, metricRows(comparison)), []);
  const failures = failuresOf(comparison);
  assert.deepEqual(failures.map(failureText), ["tea-box on another mode than in the first run from 12.3 s on"]);
  assert.equal(failureSentence(comparison, failures), "The runs disagree on tea-box.");
});

test("runs of other stamps or of other files are no comparison by frame, and this is said", async () => {
  const apart = await read([GOOD, { ...EQUAL, start: 1000 }]);
  assert.ok(apart.cautions.some((text) => text.includes("no stamp in common")));
  const report = comparisonReport([GOOD, EQUAL]);
  const runs = report["runs"] as unknown as PackedRun[];
  (runs[1].documents["metrics.json"] as { provenance: { inputs: { sha256: string }[] } }).provenance.inputs[0].sha256 = "other";
  assert.ok((await readComparison(runs)).cautions.some((text) => text.includes("different input files")));
});
