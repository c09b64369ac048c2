// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import assert from "node:assert/strict";
import { test } from "node:test";
import { DEGREES, quaternionOf } from "../../src/math/rotation.ts";
import { normal, uniform } from "../../src/mixture/sample.ts";
import { coverageOf, coverageText, grossText, normalized, outside, percent, shareBelow } from "../../src/plots/coverage.ts";
import { worstDirection } from "../../src/plots/direction.ts";
import { aligned, ape, type Pairs, pairsOf, rpe, stepsFor, umeyama } from "../../src/plots/evo.ts";
import { beyondText, countBeyond } from "../../src/plots/marks.ts";
import { reliabilityOf } from "../../src/plots/reliability.ts";
import { spreadOf, usualRange } from "../../src/plots/series.ts";
import { logTicks, short, ticks } from "../../src/plots/ticks.ts";
import { TimeWindow } from "../../src/plots/window.ts";
import { rightAt } from "../../src/trace/right_mode.ts";
import { hasSquares, neesOf, nisOf } from "../../src/trace/squares.ts";
import { readTrace } from "../../src/trace/trace.ts";
import { packTrace } from "../pack.ts";
import { FACTORS, FRAMES, riverTrace, SIGMA_M, WRONG } from "../river_trace.ts";

const close = (actual: number, expected: number, tolerance: number) => assert.ok(Math.abs(actual - expected) <= tolerance, `${actual} is not ${expected}`);
const gauss = normal(uniform(9));

/** A path along an arc with turns, and the same moved by a rotation about z and a shift. */
function pairs(moved: boolean, noise = 0): Pairs {
  const n = 101;
  const made: Pairs = {
    count: n, seconds: Float64Array.from({ length: n }, (_, i) => 0.1 * i), places: new Float64Array(3 * n), truePlaces: new Float64Array(3 * n),
    turns: new Float64Array(4 * n), trueTurns: new Float64Array(4 * n),
  };
  const q = [0, 0, 0, 1];
  for (let i = 0; i < n; ++i) {
    const angle = i / 20;
    const [x, y, z] = [0.1 * i, Math.sin(angle), 0.2 * Math.cos(2 * angle)];
    made.truePlaces.set([x, y, z], 3 * i);
    quaternionOf([0, 0, angle], q);
    made.trueTurns.set(q, 4 * i);
    quaternionOf([0, 0, angle - (moved ? 0.5 : 0)], q);
    made.turns.set(q, 4 * i);
    const [c, s] = moved ? [Math.cos(-0.5), Math.sin(-0.5)] : [1, 0];
    const [u, v] = moved ? [x - 1, y + 2] : [x, y];
    made.places.set([c * u - s * v + noise * gauss(), s * u + c * v + noise * gauss(), z + noise * gauss()], 3 * i);
  }
  return made;
}

test("Umeyama finds the motion between two worlds, after which nothing is left", () => {
  const made = pairs(true);
  assert.ok(Math.max(...ape(made).distance) > 500);
  const motion = umeyama(made)!;
  const { distance, angle } = ape(aligned(made, motion));
  assert.ok(Math.max(...distance) < 1e-6, `${Math.max(...distance)}`);
  assert.ok(Math.max(...angle) < 1e-5);
  close(2 * Math.atan2(motion.turn[2], motion.turn[3]), 0.5, 1e-9);
  close(motion.shift[0], 1, 1e-9);
  close(motion.shift[1], -2, 1e-9);
});

test("a path that does not move, or along a line, cannot be aligned", () => {
  const made = pairs(false);
  made.places.fill(1);
  assert.equal(umeyama(made), undefined);
  for (let i = 0; i < made.count; ++i) made.places.set([i, 0, 0], 3 * i);
  assert.equal(umeyama(made), undefined);
});

test("RPE of a path that is only moved is zero; of one that drifts it is the drift by frames, time and distance", () => {
  const none = rpe(pairs(true), { frames: 10 });
  assert.equal(none.distance.length, 91);
  assert.ok(Math.max(...none.distance) < 1e-6 && Math.max(...none.angle) < 1e-5);
  const drift = pairs(false);
  for (let i = 0; i < drift.count; ++i) {
    drift.truePlaces.set([0.1 * i, 0, 0], 3 * i);
    drift.places.set([0.101 * i, 0, 0], 3 * i);
    drift.trueTurns.set([0, 0, 0, 1], 4 * i);
    drift.turns.set([0, 0, 0, 1], 4 * i);
  }
  for (const [step, expected, count] of [[{ frames: 5 }, 5, 96], [{ seconds: 1 }, 10, 91], [{ metres: 2 }, 20, 81]] as const) {
    const { distance } = rpe(drift, step);
    assert.equal(distance.length, count);
    for (const value of distance) close(value, expected, 1e-6);
  }
  assert.deepEqual(stepsFor(drift).map(({ name }) => name), ["1 frame", "0.1 s", "1 s", "5 s", "0.01 m", "0.1 m", "0.5 m", "1 m", "5 m"]);
});

test("coverage: shares, factor and verdict of white errors", () => {
  const errors = Array.from({ length: 4000 }, () => 2 * gauss());
  const found = coverageOf(errors, errors.map(() => 1))!;
  // Of a Gaussian 1, 2 and 3 sigma that are twice too small are 0.5, 1 and 1.5.
  [0.3829, 0.6827, 0.8664].forEach((share, i) => close(found.shares[i], share, 0.025));
  close(Math.sqrt(found.square.mean), 2, 0.06);
  assert.match(coverageText(found), /^8\d % within 3 sigma \(99.7 % expected\): overconfident, sigma is (1\.9|2\.0|2\.1) times too small/);
  assert.match(coverageText(coverageOf(errors, errors.map(() => 2))!), /: consistent$/);
  assert.match(coverageText(coverageOf(errors, errors.map(() => 6))!), /: cautious, sigma is 3\.\d times too large$/);
  assert.equal(coverageOf([null, 1], [1, null]), undefined);
});

test("a few frames on a wrong mode do not make the others overconfident, many do", () => {
  const errors = Array.from({ length: 1000 }, (_, i) => (i < 5 ? 180 : gauss()));
  const few = coverageOf(errors, errors.map(() => 1))!;
  assert.equal(few.square.verdict, "consistent");
  assert.equal(grossText(few), ", but for 5 frames beyond 6 sigma");
  const many = coverageOf(errors.map((error, i) => (i % 5 === 0 ? 20 * gauss() : error)), errors.map(() => 1))!;
  assert.equal(many.square.verdict, "overconfident");
  assert.equal(many.gross, 0);
});

test("what is missing counts nowhere", () => {
  assert.deepEqual([...normalized([2, null, 3], [1, 1, null])], [2]);
  assert.deepEqual(outside([1, -4, null, 5], [3, 3, 3, null]), [null, -4, null, null]);
  assert.equal(shareBelow([1, 4, null], [3, 3, 3]), 0.5);
  assert.equal(shareBelow([null], [1]), undefined);
});

test("shares in percent do not round to what they are not", () => {
  assert.deepEqual([0, 1, 0.9973, 0.84, 0.99996, 0.00001, 0.004].map(percent), ["0 %", "100 %", "99.7 %", "84 %", ">99.9 %", "<0.1 %", "0.4 %"]);
});

test("ranges: the error is seen though detections are far out, and all but a hundredth of it is inside", () => {
  const error = Array.from({ length: 1000 }, (_, i) => (i < 3 ? 176 : 1));
  const detections = Array.from({ length: 1000 }, (_, i) => (i % 5 === 0 ? 180 : 3));
  const [low, high] = usualRange([{ label: "e", values: error }, { label: "d", values: detections, kind: "dots" }, { label: "s", values: error.map(() => 100), kind: "shade" }], true);
  assert.equal(low, 0);
  assert.ok(high >= 1 && high < 15, `${high}`);
  assert.deepEqual(usualRange([{ label: "e", values: [] }], false), [-1, 1]);
  const dots = usualRange([{ label: "d", values: detections, kind: "dots" }], false);
  assert.ok(dots[1] > 3 && dots[1] < 40 && dots[0] === -dots[1], `${dots}`);
});

test("values beyond the edges are counted in the shown part alone", () => {
  assert.deepEqual(countBeyond([0, 1, 2, 3, 4], [9, 9, null, -9, 0], [1, 4], [-5, 5]), { above: 1, below: 1 });
  assert.equal(beyondText("error", { above: 1, below: 0 }), "error: 1 frame beyond");
  assert.equal(beyondText("error", { above: 3, below: 2 }), "error: 5 frames beyond");
  assert.equal(beyondText("error", { above: 0, below: 0 }), "");
});

test("ticks are round", () => {
  assert.deepEqual(ticks(0, 60, 8), [0, 10, 20, 30, 40, 50, 60]);
  assert.deepEqual(ticks(-0.3, 0.31, 6), [-0.2, 0, 0.2]);
  assert.deepEqual(ticks(1, 1, 5), []);
  assert.deepEqual(logTicks(0.05, 1000, 6), [0.1, 1, 10, 100, 1000]);
  assert.deepEqual([0, 0.00001, 1234567, 0.12345].map((value) => short(value)), ["0", "1.0e-5", "1.2e+6", "0.1235"]);
});

test("the shown part of the time: zooms about the playhead, never beyond the run, and tells of changes once", () => {
  const shown = new TimeWindow();
  let told = 0;
  shown.onChange(() => ++told);
  shown.zoom(0.5, 10, [0, 100]);
  assert.deepEqual(shown.range, [5, 55]);
  shown.zoom(0.5, 90, [0, 100]);
  assert.deepEqual(shown.range, [17.5, 42.5]);
  shown.set([17.5, 42.5]);
  shown.set([5, 5]);
  assert.equal(told, 2);
  shown.zoom(10, 20, [0, 100]);
  assert.equal(shown.range, undefined);
  assert.equal(told, 3);
});

test("the run of known errors: sigmas, bounds, worst direction, NEES, NIS, and the right mode", async () => {
  const trace = await readTrace(packTrace(riverTrace()));
  const { camera, objects } = trace;
  const sigma = spreadOf(camera!, FRAMES);
  close(sigma.position[0][10]!, 1000 * SIGMA_M, 0.003);
  // 99.73 % of chi with three degrees of freedom: 3.7625 sigma.
  close(sigma.distance[10]! / (1000 * SIGMA_M), 3.7625, 0.01);
  close(sigma.angle[10]! / (0.002 * DEGREES), 3.7625, 0.01);
  const { along, factor } = worstDirection(camera!, FRAMES)!;
  assert.ok(along[1] > 0.99, `${along}`);
  close(factor, FACTORS[1], 0.15);
  assert.ok(hasSquares(trace, "nees") && hasSquares(trace, "nis"));
  const nees = neesOf(trace, -1, "world")!;
  close(nees(20)!, 30, 0.2);
  close(nees(21)!, 6, 0.05);
  const nis = nisOf(trace, 1)!;
  assert.equal(nis(4), undefined);
  close(nis(11)!, 20, 0.2);
  assert.equal(nisOf(trace, -1), undefined);
  const right = rightAt(objects[1].relative!);
  for (let frame = 0; frame < FRAMES; ++frame) assert.equal(right(frame), frame < WRONG.first || frame > WRONG.last);
  const found = reliabilityOf(trace, [objects[1]])!;
  assert.equal(found.frames, FRAMES);
  // While it is wrong it says 0.55, and never else.
  assert.deepEqual({ frames: found.bins[5].frames, right: found.bins[5].right }, { frames: WRONG.last - WRONG.first + 1, right: 0 });
  close(found.bins[5].said / found.bins[5].frames, 0.55, 1e-4);
  assert.equal(found.bins[7].right, found.bins[7].frames);
  const blind = await readTrace(packTrace(riverTrace(false)));
  assert.equal(reliabilityOf(blind, blind.objects), undefined);
  assert.equal(neesOf(blind, 0, "relative"), undefined);
  assert.equal(pairsOf(camera!.pose, camera!.truth!, trace.seconds).count, FRAMES);
});
