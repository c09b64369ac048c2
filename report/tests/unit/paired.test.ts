// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import assert from "node:assert/strict";
import { test } from "node:test";
import { normal, uniform } from "../../src/mixture/sample.ts";
import { effectiveSize, holm, incompleteBeta, paired, studentP, studentQuantile } from "../../src/stats/paired.ts";

const near = (value: number, expected: number, tolerance: number) => assert.ok(Math.abs(value - expected) <= tolerance, `${value} is not ${expected}`);

/** A series with correlation rho between neighbours. */
function correlated(count: number, rho: number, seed: number): number[] {
  const gauss = normal(uniform(seed));
  let last = gauss();
  return Array.from({ length: count }, () => (last = rho * last + Math.sqrt(1 - rho * rho) * gauss()));
}

test("Student's t is that of SciPy 1.17 (2 * stats.t.sf(|t|, dof) and stats.t.isf(p / 2, dof))", () => {
  const tails: [number, number, number][] = [
    [0.1, 1, 0.936548965138893],
    [2, 1.5, 0.22418833035605112],
    [12.706204736, 1, 0.050000000000684656],
    [3, 7.25, 0.019134132993169097],
    [-2.5, 30, 0.01811564906806669],
    [6, 199.5, 9.146519892245594e-9],
    [40, 5, 1.8411962171772954e-7],
    [1.959963985, 1e6, 0.05000027724145847],
    [9, 1e4, 2.6678432694686606e-19],
  ];
  for (const [t, dof, p] of tails) assert.ok(Math.abs(studentP(t, dof) / p - 1) < 1e-7, `${t} ${dof}: ${studentP(t, dof)}`);
  const quantiles: [number, number, number][] = [
    [0.05, 1, 12.706204736174705],
    [0.05, 3.7, 2.8675207071911903],
    [0.05, 250, 1.9694983934211538],
    [0.001, 12, 4.3177912836061845],
  ];
  for (const [p, dof, t] of quantiles) assert.ok(Math.abs(studentQuantile(p, dof) / t - 1) < 1e-7, `${p} ${dof}: ${studentQuantile(p, dof)}`);
});

test("Student's t, against tables", () => {
  near(studentP(2.228, 10), 0.05, 1e-4);
  near(studentP(-12.706, 1), 0.05, 1e-4);
  near(studentP(2.576, 1e6), 0.01, 1e-4);
  assert.equal(studentP(0, 5), 1);
  near(studentQuantile(0.05, 10), 2.228, 1e-3);
  near(incompleteBeta(2, 3, 0.4), 0.5248, 1e-6);
});

test("correlated frames count as few, independent ones as themselves", () => {
  near(effectiveSize(correlated(4000, 0, 1)) / 4000, 1, 0.12);
  // (1 - rho) / (1 + rho) of the frames.
  near(effectiveSize(correlated(20000, 0.9, 2)) / 20000, 1 / 19, 0.02);
  assert.equal(effectiveSize([1, 1, 1, 1]), 4);
  assert.equal(effectiveSize([]), 0);
});

test("chance alone is rarely called a difference, also of correlated errors", () => {
  let found = 0;
  const trials = 300;
  for (let k = 0; k < trials; ++k) {
    const { p } = paired(correlated(600, 0.8, 10 + 2 * k), correlated(600, 0.8, 11 + 2 * k));
    if (p !== undefined && p < 0.05) ++found;
  }
  assert.ok(found / trials < 0.1, `${found} of ${trials}`);
});

test("a difference is found, with its sign and its frames", () => {
  const a = correlated(500, 0.5, 5);
  const one = paired(a.map((value) => value + 1), correlated(500, 0.5, 6));
  near(one.difference, 1, 0.3);
  assert.ok(one.p! < 0.001);
  assert.ok(one.effective < 400);
  assert.deepEqual(paired([1, null, 3], [1, 2, null]), { frames: 1, effective: 1, difference: 0, standardError: 0, p: 1 });
  assert.equal(paired([null], [1]).frames, 0);
});

test("one change of level is too little to decide", () => {
  const step = Array.from({ length: 200 }, (_, i) => (i < 123 ? 0 : 180));
  assert.equal(paired(step, step.map(() => 0)).p, undefined);
});

test("long series are put together into blocks, and say the same", () => {
  const a = correlated(30000, 0.9, 8);
  const long = paired(a, a.map(() => 0));
  near(long.standardError, Math.sqrt(19 / 30000), 0.006);
  assert.equal(long.frames, 30000);
});

test("Holm raises the smallest most, and keeps their order", () => {
  assert.deepEqual(holm([0.01, undefined, 0.04, 0.02]), [0.03, undefined, 0.04, 0.04]);
  assert.deepEqual(holm([0.9, 0.8]), [1, 1]);
});
