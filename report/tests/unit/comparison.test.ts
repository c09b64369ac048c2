// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import assert from "node:assert/strict";
import { test } from "node:test";
import { failuresOf, failureText, spellsOf } from "../../src/compare/failures.ts";
import { type Cell, cellNote, inCommon, type MetricRow, metricRows } from "../../src/compare/metrics.ts";
import { type Comparison, distinctNames, placesOf, readComparison, unionOf } from "../../src/compare/runs.ts";
import { failureSentence, rowSentence, verdictSentences } from "../../src/compare/verdict.ts";
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

test("who is honestly unsure is on no wrong mode", async () => {
  // Half a turn is beyond no bound of 2.4 m, but beyond that of the rotation: the spell is one of the rotation.
  const sure = failuresOf(await read([GOOD, FAILING]));
  assert.equal(sure.length, 1);
  const moved = (positionSd: number) => read([GOOD, { ...EQUAL, offset: 0.22, positionSd }]);
  const [wrong] = failuresOf(await moved(0.005)).filter(({ id }) => id === "mug");
  assert.match(wrong.why, /^off by 220 mm, its own 99\.7 % bound is 19 mm/);
  const unsure = await moved(0.64);
  assert.deepEqual(failuresOf(unsure), []);
  assert.equal(failureSentence(unsure, []), "No run was on a wrong mode for half a second or more.");
  // Far beyond a large bound, lengths are in metres.
  const far = failuresOf(await read([GOOD, { ...EQUAL, offset: 9, positionSd: 0.64 }]))[0];
  assert.match(far.why, /^off by 9 m, its own 99\.7 % bound is 2\.4 m/);
});

test("runs of different recordings are neither tested nor ranked", async () => {
  for (const [other, why] of [[{ recording: 2 }, "different detections"], [{ truthShift: 0.01 }, "different true poses"]] as const) {
    const comparison = await read([GOOD, { ...EQUAL, ...other }]);
    assert.equal(comparison.isOneRecording, false);
    assert.ok(comparison.cautions.some((text) => text.includes(`${why} at the same stamps`) && text.includes("neither tested nor ranked")), comparison.cautions.join());
    const rows = metricRows(comparison);
    assert.ok(rows.length > 4 && rows.every(({ best, cells }) => best === -1 && cells.every(({ test }) => test === undefined)));
    assert.deepEqual(verdictSentences(comparison, rows), []);
  }
  assert.equal((await read([GOOD, EQUAL, FAILING])).isOneRecording, true);
  const twice = await read([{ ...GOOD, id: "9b" }, { ...GOOD, name: "again", id: "9b" }]);
  assert.ok(twice.cautions.some((text) => text.startsWith("multi-object and again are the same run")));
});

test("of a run without truth nobody can say on which mode it is", async () => {
  const mixed = await read([GOOD, { ...EQUAL, truth: false }]);
  assert.equal(failureSentence(mixed, failuresOf(mixed)), "multi-object was on no wrong mode for half a second or more; gm-iekf has no ground truth and cannot be judged.");
  const none = await read([{ ...GOOD, truth: false }, { ...EQUAL, truth: false }]);
  assert.match(failureSentence(none, failuresOf(none)), /without ground truth none can be judged/);
});

test("shares differ by points, small differences by per cent, and few frames tell nothing", async () => {
  const rows = metricRows(await read([GOOD, FAILING]));
  const names = ["a", "b"];
  const right = rows.find(({ entity, quantity }) => entity.startsWith("tea-box") && quantity.startsWith("frames on"))!;
  assert.match(cellNote(right, right.cells[1], names), /: −38\.5 points,|^−38\.5 points,/);
  const turn = rows.find(({ entity, quantity }) => entity.startsWith("tea-box") && quantity.startsWith("rotation"))!;
  assert.equal(turn.cells[1].verdict, "undecided");
  assert.match(cellNote(turn, turn.cells[1], names), /^not told apart from a/);
  const test = { frames: 600, effective: 30, difference: 0.5, standardError: 0.1, p: 0.013 };
  const row = (value: number, verdict: "worse" | "tie" | "undecided"): MetricRow => ({
    entity: "box", quantity: "position error, rms", unit: "mm", better: "small", best: 2, frames: 600, cells: [
      { value: 30, verdict: "tie", test, p: 0.5, interval: [0, 1] }, { value, verdict, test, p: 0.013, interval: [0, 1] },
      { value: 18.84, verdict: "best", test: undefined, p: undefined, interval: undefined },
    ],
  });
  assert.equal(rowSentence(row(19.13, "worse"), ["x", "y", "z"]), "Box, position error, rms: z (18.8 mm) and x (30 mm) are a tie; y has 19.1 mm (2 % more, p = 0.013).");
  assert.match(rowSentence(row(57, "worse"), ["x", "y", "z"]), /y has 57 mm \(3 times as much, p = 0\.013\)/);
  assert.match(rowSentence(row(19, "tie"), ["x", "y", "z"]), /z \(18\.8 mm\), y \(19 mm\) and x \(30 mm\) are a tie/);
});

test("what is told apart is not listed among what is not", () => {
  const test = { frames: 600, effective: 30, difference: 0.5, standardError: 0.1, p: 0.5 };
  const row = (id: string): MetricRow => ({
    entity: `${id} from the camera`, quantity: "rotation error, rms", unit: "deg", better: "small", best: 0, frames: 600, cells: [
      { value: 7, verdict: "best", test: undefined, p: undefined, interval: undefined }, { value: 14, verdict: "undecided", test, p: 0.5, interval: [-7, 20] },
      { value: 179, verdict: "worse", test, p: 0, interval: [160, 180] },
    ],
  });
  const runs = ["a", "b", "c"].map((name) => ({ name }));
  const [text] = verdictSentences({ runs, hasTruth: true } as unknown as Comparison, [row("mug"), row("box")]);
  assert.match(text, /not told apart for mug \(a 7 deg, b 14 deg; too few independent frames\) and box/);
});

test("what the interval tells apart, and only the correction for several comparisons does not, is not put on too few frames", () => {
  const test = { frames: 600, effective: 59, difference: 0.5, standardError: 0.2, p: 0.03 };
  const cell = (value: number, interval: [number, number], p: number): Cell => ({ value, verdict: "undecided", test: { ...test, p }, p: 7 * p, interval });
  const row = (...cells: Cell[]): MetricRow => ({
    entity: "mug from the camera", quantity: "rotation error, rms", unit: "deg", better: "small", best: 0, frames: 600,
    cells: [{ value: 0.344, verdict: "best", test: undefined, p: undefined, interval: undefined }, ...cells],
  });
  const names = ["a", "b", "c"];
  const [beyond, around] = [cell(0.643, [0.024, 0.492], 0.03), cell(0.4, [-0.1, 0.3], 0.1)];
  const several = "p = 0.21 over all comparisons (Holm)";
  assert.equal(cellNote(row(beyond), beyond, names), `not told apart from a: +0.299 deg (+87 %), with 95 % between +7 and +143 %, 59 independent frames; ${several}`);
  assert.match(cellNote(row(around), around, names), /59 independent frames$/);
  assert.equal(rowSentence(row(beyond, around), names), `Mug from the camera, rotation error, rms: a has the best value (0.344 deg); c has 0.4 deg (not told apart: too few independent frames); b has 0.643 deg (not told apart: ${several}).`);
  // Of shares the larger is the better: the whole interval is below zero.
  assert.match(rowSentence({ ...row(cell(80, [-30, -2], 0.03)), unit: "%", better: "large" }, names), /over all comparisons \(Holm\)/);
  const sentenceOf = (...cells: Cell[]) => verdictSentences({ runs: names.map((name) => ({ name })), hasTruth: true } as unknown as Comparison, [row(...cells), row(...cells)])[0];
  assert.ok(sentenceOf(beyond).includes(`mug (a 0.344 deg, b 0.643 deg; ${several}) and mug`));
  assert.ok(sentenceOf(beyond, around).includes(`mug (a 0.344 deg, c 0.4 deg, b 0.643 deg; b: ${several}; c: too few independent frames) and mug`));
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
