// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import assert from "node:assert/strict";
import { test } from "node:test";
import { findingsOf, sentences } from "../../src/pages/consistency_findings.ts";
import { wordOf } from "../../src/pages/words.ts";
import { rotationText, sigmaText } from "../../src/state/pose_display.ts";
import { RunFacts } from "../../src/state/run_facts.ts";
import { CAMERA, RunState } from "../../src/state/run_state.ts";
import { EventChoice } from "../../src/state/event_choice.ts";
import { cameraSentence, comparison, detectorSentence, durationSentence } from "../../src/trace/summary.ts";
import { readTrace } from "../../src/trace/trace.ts";
import { findingIn, sizeText, verdictOfCoverage, verdictOfErrors, verdictOfInnovations } from "../../src/trace/verdict.ts";
import { decimalsOf, fixed, percent, short } from "../../src/ui/numbers.ts";
import { poseText } from "../../src/ui/pose_text.ts";
import { leastByPixel } from "../../src/trace/sureness.ts";
import { normal, uniform } from "../../src/mixture/sample.ts";
import { AT, eventfulMetrics, eventfulTrace, FRAMES, IDS } from "../eventful.ts";
import { packTrace } from "../pack.ts";
import { syntheticTrace } from "../synthetic.ts";

test("numbers: no -0.0, three digits, no false certainty", () => {
  assert.deepEqual([-0.04, -0.06, 0, 1.25].map((value) => fixed(value, 1)), ["0.0", "-0.1", "0.0", "1.3"]);
  assert.deepEqual([0, 0.01234, 1.234, 123.4, 12345, -6.5, NaN].map(short), ["0", "0.0123", "1.23", "123", "12345", "-6.50", "–"]);
  assert.deepEqual([percent(0.57), percent(0.99999), percent(1), percent(1e-5), percent(0), percent(undefined), percent(0.99996, 1)],
    ["57 %", ">99 %", "100 %", "<1 %", "0 %", "–", ">99.9 %"]);
  assert.deepEqual([[2.61, 3.2, 10.21], [100, 80], [0.0026, 0.0123], [1152], [45.1, 5.88], [], [0]].map(decimalsOf), [2, 1, 4, 0, 2, 0, 0]);
});

test("rotations as text", () => {
  const q = [0, 0, -Math.SQRT1_2, -Math.SQRT1_2];
  assert.equal(rotationText(q, "rpy"), "0.0, 0.0, 90.0");
  assert.equal(rotationText(q, "vector"), "0.0, 0.0, 90.0");
  assert.equal(rotationText(q, "quaternion"), "0.0000, 0.0000, 0.7071, 0.7071");
  assert.equal(sigmaText([1, NaN, 2], "mm"), "");
  assert.equal(sigmaText([1, 12.34, 0.1], "mm"), "± 1.00, 12.3, 0.100 mm");
});

test("a pose for other programs; names stay names", () => {
  const pose = { from: "world", to: 'a"\n: b', stamp: 12.25, p: [1, -0.5, 0.000000001], q: [0, 0, Math.SQRT1_2, Math.SQRT1_2] };
  assert.equal(poseText(pose, "quaternion"), "1 -0.5 0.000000001 0 0 0.707106781 0.707106781");
  assert.deepEqual(JSON.parse(poseText(pose, "matrix")), [[0, -1, 0, 1], [1, 0, 0, -0.5], [0, 0, 1, 1e-9], [0, 0, 0, 1]]);
  const lines = poseText(pose, "ros").split("\n");
  assert.equal(lines[0], '# "a\\"\\n: b" in "world"');
  assert.ok(lines.includes("  stamp: {sec: 12, nanosec: 250000000}") && lines.includes("  position: {x: 1, y: -0.5, z: 0.000000001}"));
});

const ERRORS = { ratios: [1, 2, 3, 4, 5, 6].map(() => new Float32Array(1000).fill(1)), largest: new Float32Array(1000).fill(1), frames: 1000 };
const outside = (most: number) => ({ ...ERRORS, outside: [0, 1, 0, most, 0, 2] });
const said = (verdict: "consistent" | "overconfident" | "cautious", anees: number, reason = "") => ({ verdict, reason, anees, interval: [0.8, 1.3] as [number, number], effective: 90.4 });

test("the program's verdict is the page's; errors far out in many frames are bad however small the mean is", () => {
  const of = (...args: Parameters<typeof said>) => (most: number) => verdictOfErrors(said(...args), undefined, outside(most));
  const inShort = ({ level, word }: { level: string; word: string }) => `${level} ${word}`;
  assert.deepEqual([of("consistent", 1)(3), of("cautious", 0.5)(0), of("overconfident", 1.4)(20), of("overconfident", 1.4)(60), of("overconfident", 2.3)(3)].map(inShort),
    ["good consistent", "fair cautious", "fair slightly overconfident", "bad overconfident", "bad overconfident"]);
  const { reason, sentence } = of("overconfident", 1.4, "17 % of position x outside 3 sigma")(170);
  assert.equal(reason, "17 % of position x outside 3 sigma. ANEES 1.4 (1 expected), 95 % interval 0.8 to 1.3 from 90.4 independent frames.");
  assert.match(sentence, /^17 % of position x outside 3 sigma\. ANEES 1\.4 per degree of freedom .* 1000 of them say as much as 90\.4 independent ones\.$/);
  assert.match(of("consistent", 1)(130).sentence, /^13 % of position x outside 3 sigma, but so few independent frames are no proof\. ANEES/);
  const coverage = (most: number) => verdictOfCoverage(outside(most));
  assert.deepEqual([3, 20, 200].map((most) => coverage(most).level), ["good", "fair", "bad"]);
  assert.match(coverage(200).reason, /^20\.0 % of the errors of position x/);
});

test("without the program's verdict NEES and errors give one, for the card and the tab alike", async () => {
  const json = eventfulTrace();
  const mug = IDS.indexOf("mug");
  for (const [metrics, text] of [[undefined, /^ANEES/], [{ consistency: { relative_verdicts: { mug: { ...said("overconfident", 9, "x"), effective_frames: 12 } } } }, /^X\. ANEES 9 .* 12 independent/]] as const) {
    const facts = new RunFacts(await readTrace(packTrace(json)), metrics);
    assert.match(facts.verdict(mug).reason, text);
    const [first, ...rest] = sentences(findingsOf(facts.trace, mug, "relative"), facts.verdictIn(mug, "relative"), "camera");
    assert.ok(first.toLowerCase().startsWith(facts.verdict(mug).word));
    assert.equal(rest.some((text) => text.startsWith("By axis, no direction")), metrics === undefined);
  }
  // What the program finds consistent for few independent frames has errors far out all the same.
  const few = new RunFacts(await readTrace(packTrace(json)), { consistency: { relative_verdicts: { "cracker-box": { ...said("consistent", 1.5), effective_frames: 3 } } } });
  const boxSaid = sentences(findingsOf(few.trace, IDS.indexOf("cracker-box"), "relative"), few.verdict(IDS.indexOf("cracker-box")), "camera");
  assert.match(boxSaid[0], /^Consistent: .* outside 3 sigma, but so few independent frames are no proof/);
  assert.ok(!boxSaid.some((text) => text.startsWith("By axis, no direction")));
  // Errors beyond 3 sigma in 8 % of the frames, of a pose whose mean NEES says little.
  const facts = new RunFacts(await readTrace(packTrace(json)));
  const cracker = facts.verdict(IDS.indexOf("cracker-box"));
  assert.deepEqual([cracker.level, cracker.word], ["bad", "overconfident"]);
  assert.match(cracker.reason, /^[\d.]+ % of position \w outside 3 sigma\. ANEES/);
  assert.equal(findingIn({ consistency: { camera_verdict: null } }, undefined), undefined);
});

test("a pose that is known exactly is no look at its covariance", async () => {
  const json = eventfulTrace();
  const exact = (rows: (number[] | null)[]) => rows.map((row, k) => (k < 10 ? row!.map(() => 0) : row));
  [json.camera.sd, json.camera.position_covariance] = [exact(json.camera.sd), exact(json.camera.position_covariance!)];
  const facts = new RunFacts(await readTrace(packTrace(json)));
  assert.equal(facts.deviation(CAMERA)!.frames, FRAMES - 10);
});

test("innovations: mostly in their band are as expected, and sizes near one are in percent", () => {
  const gauss = normal(uniform(3));
  const squares = (scale: number) => Float32Array.from({ length: 3000 }, () => scale * [1, 2, 3, 4, 5, 6].reduce((sum) => sum + gauss() ** 2, 0));
  const words = [1, 1.06, 1.5, 4, 0.5].map((scale) => verdictOfInnovations(squares(scale))!.word);
  assert.deepEqual(words, ["innovations as expected", "innovations as expected", "innovations large", "innovations too large", "innovations small"]);
  assert.equal(verdictOfInnovations(new Float32Array(3).fill(NaN)), undefined);
  assert.deepEqual([1.04, 1.6, 0.95, 0.5, 1.001].map(sizeText), ["4 % too small", "1.6 times too small", "5 % too large", "2.0 times too large", "1 % too small"]);
});

test("an object with truth that was never estimated, and one without truth", async () => {
  const json = eventfulTrace();
  for (const pose of [json.objects["mug"].world, json.objects["mug"].relative]) pose.pose = pose.pose.map(() => null);
  json.objects["mug"].nis = json.objects["mug"].nis!.map(() => null);
  const facts = new RunFacts(await readTrace(packTrace(json)));
  assert.equal(facts.verdict(IDS.indexOf("mug")).reason, "It was never estimated.");
  const single = verdictOfInnovations(Float32Array.from([6, NaN]))!;
  assert.match(single.sentence, /That is one frame alone\./);
});

test("the facts of a run: order, verdict, worst moment", async () => {
  const facts = new RunFacts(await readTrace(packTrace(eventfulTrace())));
  assert.equal(facts.byDoubt[0], IDS.indexOf("tea-box"));
  assert.equal(facts.verdict(IDS.indexOf("mug")).level, "good");
  assert.equal(facts.verdict(IDS.indexOf("tea-box")).level, "bad");
  assert.notEqual(facts.verdict(IDS.indexOf("cracker-box")).level, "good");
  const worst = facts.worst(IDS.indexOf("cracker-box"))!;
  assert.ok(worst.of === "error" && worst.frame >= AT.dragged[0] && worst.frame <= AT.dragged[1]);
  const without = new RunFacts(await readTrace(packTrace(eventfulTrace({ truth: false }))));
  assert.deepEqual([without.verdict(CAMERA).level, without.verdict(0).word], ["none", "innovations as expected"]);
  assert.deepEqual(without.worst(1), { frame: 0, of: "mode", size: without.trace.objects[1].modeProbability!(0) });
});

test("sentences of metrics.json", () => {
  assert.deepEqual([comparison(1, 3.2), comparison(2, 1), comparison(1, 1.01)], ["3.2 times smaller", "2.0 times larger", "as large"]);
  assert.match(cameraSentence(eventfulMetrics())!, /5\.88 mm and 0\.758 deg\. Odometry alone has 45\.1 mm .* 7\.7 times smaller/);
  assert.equal(cameraSentence({ camera: { position_rmse_m: null } }), undefined);
  const beside = (position: number, rotation: number) => cameraSentence({ camera: { position_rmse_m: 0.002, rotation_rmse_deg: 1 }, odometry: { position_rmse_m: position, rotation_rmse_deg: rotation } })!;
  assert.equal(beside(0, 1e-9), "Camera: rms error 2.00 mm and 1.00 deg.");
  assert.match(beside(0.001, 3), /: the filter is worse than odometry alone in position: its position error is 2\.0 times larger, its rotation error 3\.0 times smaller\.$/);
  assert.match(beside(0.001, 0.5), /: the filter is worse than odometry alone: its position error/);
  assert.match(detectorSentence(eventfulMetrics())!, /2\.7 times smaller than that of the detector/);
  assert.equal(detectorSentence({ objects: { a: {} } }), undefined);
  // Of two objects neither is the median: 2 and 4 times smaller are 3 times smaller.
  const pairedWith = (ratio: number) => ({ paired: { estimate: { position_median_m: 0.001, rotation_median_deg: 1 }, detection: { position_median_m: 0.001 * ratio, rotation_median_deg: ratio } } });
  assert.match(detectorSentence({ objects: { a: pairedWith(2), b: pairedWith(4) } })!, /is 3\.0 times smaller than that of the detector, the rotation error 3\.0 times smaller \(median/);
});

test("a single frame lasts no time", async () => {
  const [one, many] = await Promise.all([1, 20].map((frames) => readTrace(syntheticTrace({ frames, objects: 1, hypotheses: 1 }))));
  assert.match(durationSentence(one), /^1 frame; 1 object; filter /);
  assert.match(durationSentence(many), /^20 frames in [\d.]+ s, [\d.]+ frames per second; /);
});

test("gated is what was not explained in older files, and a part of it in others", () => {
  assert.equal(wordOf("gated", true), wordOf("objects/unexplained"));
  assert.equal(wordOf("unexplained")!.name, "not explained");
  assert.notEqual(wordOf("gated")!.name, wordOf("unexplained")!.name);
  assert.equal(wordOf("toString"), undefined);
});

test("steps from event to event, of all objects or the selected one", async () => {
  const trace = await readTrace(packTrace(eventfulTrace()));
  const facts = new RunFacts(trace);
  const state = new RunState(trace, 0);
  const events = new EventChoice(state, facts);
  state.go(AT.flip - 1);
  events.step(1, false);
  assert.deepEqual([state.frame, state.nameOf(state.selected)], [AT.flip, "tea-box"]);
  events.step(1, true);
  assert.deepEqual([state.frame, state.nameOf(state.selected)], [AT.pruned, "tea-box"]);
  events.step(-1, false);
  assert.equal(state.frame, AT.moves[0]);
  events.setKind("flipped", false);
  events.step(-1, false);
  assert.equal(state.frame, AT.enters);
});

test("every event of a frame is reached, and the caption is that of the selected object", async () => {
  const json = eventfulTrace();
  const trace = await readTrace(packTrace(json));
  const state = new RunState(trace, 0);
  const events = new EventChoice(state, new RunFacts(trace));
  // All that are there at first enter at frame 0.
  const first = events.events.filter(({ from }) => from === 0);
  assert.ok(first.length >= 5);
  for (const { entity } of first) {
    state.select(entity);
    assert.equal(events.at(0)!.entity, entity);
  }
  state.go(1);
  const back = first.map(() => (events.step(-1, false), events.at(0)));
  assert.deepEqual(back, [...first].reverse());
  const there = first.slice(1).map(() => (events.step(1, false), events.at(0)));
  assert.deepEqual(there, first.slice(1));
  events.step(1, false);
  assert.ok(state.frame > 0);
});

test("strips show the least of every pixel", async () => {
  const trace = await readTrace(packTrace(eventfulTrace()));
  const least = leastByPixel(trace, IDS.indexOf("tea-box"), 30);
  assert.ok(Math.abs(least[0] - 0.57) < 1e-3 && least[29] > 0.99);
  assert.ok(Number.isNaN(leastByPixel(trace, IDS.indexOf("late-cup"), 30)[0]));
  assert.equal(leastByPixel(trace, 0, 900).filter(Number.isNaN).length, 0);
});
