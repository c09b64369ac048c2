// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import assert from "node:assert/strict";
import { test } from "node:test";
import { chiSquareCdf, chiSquareQuantile, gammaP, logGamma, shareWithin } from "../../src/math/chi_square.ts";
import { eigenOf } from "../../src/math/eigen.ts";
import { cholesky } from "../../src/math/linear.ts";
import { BOUND_SHARE, normBound } from "../../src/math/norm_bound.ts";
import { effectiveFrames, effectiveSamples, meanSquare, median, quantileOfSorted, shareInterval, summaryOf } from "../../src/math/statistics.ts";
import { normal, uniform } from "../../src/mixture/sample.ts";

const close = (actual: number, expected: number, relative: number) =>
  assert.ok(Math.abs(actual - expected) <= relative * Math.abs(expected), `${actual} is not ${expected}`);

test("chi-square quantiles are those of the tables", () => {
  // NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.4, critical values of the chi-square distribution.
  const upper: [number, number, number][] = [
    [1, 0.9, 2.706], [1, 0.95, 3.841], [1, 0.99, 6.635], [1, 0.999, 10.828], [2, 0.95, 5.991], [3, 0.95, 7.815], [3, 0.99, 11.345],
    [6, 0.9, 10.645], [6, 0.95, 12.592], [6, 0.975, 14.449], [6, 0.99, 16.812], [6, 0.999, 22.458], [10, 0.975, 20.483],
    [50, 0.95, 67.505], [100, 0.975, 129.561], [100, 0.999, 149.449],
  ];
  // The same place, lower critical values.
  const lower: [number, number, number][] = [[1, 0.05, 0.004], [3, 0.05, 0.352], [6, 0.025, 1.237], [6, 0.01, 0.872], [10, 0.025, 3.247], [100, 0.025, 74.222]];
  for (const [dof, probability, value] of [...upper, ...lower]) {
    assert.ok(Math.abs(chiSquareQuantile(probability, dof) - value) <= 0.00051, `${dof} ${probability}: ${chiSquareQuantile(probability, dof)}`);
  }
});

test("chi-square with two degrees of freedom is exponential, and quantiles undo the distribution at any number of them", () => {
  for (const p of [1e-6, 0.3, 0.999]) close(chiSquareQuantile(p, 2), -2 * Math.log(1 - p), 1e-9);
  for (const dof of [0.3, 1, 2.7, 6, 431.9, 120000]) {
    for (const p of [0.001, 0.025, 0.5, 0.975, 0.9999]) assert.ok(Math.abs(chiSquareCdf(chiSquareQuantile(p, dof), dof) - p) < 1e-8, `${dof} ${p}`);
  }
  // Of many degrees of freedom it is nearly Gaussian: mean n, variance 2 n.
  close(chiSquareQuantile(0.975, 120000), 120000 + 1.959964 * Math.sqrt(240000), 1e-4);
  assert.equal(chiSquareQuantile(0, 3), 0);
  assert.equal(chiSquareQuantile(1, 3), Infinity);
});

test("the gamma function is a factorial, and shares of a Gaussian are 68.27, 95.45 and 99.73 %", () => {
  close(logGamma(11), Math.log(3628800), 1e-12);
  close(logGamma(0.5), 0.5 * Math.log(Math.PI), 1e-12);
  close(gammaP(1, 2), 1 - Math.exp(-2), 1e-13);
  [0.682689492137, 0.954499736104, 0.997300203937].forEach((share, i) => close(shareWithin(i + 1), share, 1e-11));
});

test("statistics of evo of a series that can be computed by hand", () => {
  const found = summaryOf([4, 1, 2, 1]);
  assert.deepEqual({ ...found, rmse: 0, std: 0 }, { count: 4, rmse: 0, mean: 2, median: 1.5, std: 0, min: 1, max: 4 });
  close(found.rmse, Math.sqrt(22 / 4), 1e-14);
  close(found.std, Math.sqrt(6 / 4), 1e-14);
  assert.equal(summaryOf([3, 1, 2]).median, 2);
  assert.equal(quantileOfSorted([0, 10, 20], 0.25), 5);
});

test("the median of an even number lies between the two in the middle, whatever their order, which stays", () => {
  const values = [10, 9, 100, -2];
  assert.equal(median(values), 9.5);
  assert.deepEqual(values, [10, 9, 100, -2]);
  assert.equal(median(Float32Array.of(3, 20, 1)), 3);
  assert.equal(median([Infinity, Infinity]), Infinity);
  assert.ok(Number.isNaN(median([])));
});

test("the effective number of frames: all of white errors, (1 - a^2) / (1 + a^2) of a first-order process, one of a constant", () => {
  const gauss = normal(uniform(11));
  const n = 40000;
  const white = Float64Array.from({ length: n }, gauss);
  close(effectiveFrames([white]), n, 0.03);
  close(effectiveSamples(white), n, 0.05);
  const a = 0.9;
  const process = new Float64Array(n);
  for (let i = 1; i < n; ++i) process[i] = a * process[i - 1] + Math.sqrt(1 - a * a) * gauss();
  close(effectiveFrames([process]), (n * (1 - a * a)) / (1 + a * a), 0.2);
  close(effectiveSamples(process), (n * (1 - a)) / (1 + a), 0.25);
  const constant = new Float64Array(500).fill(0.7);
  assert.ok(effectiveFrames([constant, constant]) < 2);
  assert.equal(effectiveSamples(constant), 1);
});

test("ANEES: sigmas that are too small by two give four, and the verdict", () => {
  const gauss = normal(uniform(5));
  const squares = (scale: number) => Float64Array.from({ length: 3000 }, () => Array.from({ length: 6 }, () => (scale * gauss()) ** 2).reduce((x, y) => x + y, 0));
  const right = meanSquare(squares(1), 6, 3000);
  assert.equal(right.verdict, "consistent");
  close(right.mean, 1, 0.03);
  const narrow = meanSquare(squares(2), 6, 3000);
  assert.equal(narrow.verdict, "overconfident");
  close(narrow.mean, 4, 0.05);
  assert.equal(meanSquare(squares(0.5), 6, 3000).verdict, "cautious");
  // Five frames cannot tell.
  assert.equal(meanSquare(squares(1.2), 6, 2).verdict, "consistent");
  assert.ok(narrow.interval[0] < 4 && narrow.interval[1] > 4);
});

test("Wilson's interval of 10 of 20 is 0.299 to 0.701, and stays within 0 and 1", () => {
  const [low, high] = shareInterval(0.5, 20);
  assert.ok(Math.abs(low - 0.2993) < 1e-4 && Math.abs(high - 0.7007) < 1e-4);
  assert.ok(shareInterval(1, 5)[1] <= 1 && shareInterval(1, 5)[0] < 0.6);
});

test("the bound of a norm is exact for a sphere and a line, and near the share of samples for others", () => {
  close(normBound([4, 0, 0, 0, 4, 0, 0, 0, 4]), 2 * Math.sqrt(chiSquareQuantile(BOUND_SHARE, 3)), 1e-4);
  close(normBound([0, 0, 0, 0, 9, 0, 0, 0, 0]), 9, 1e-4);
  const gauss = normal(uniform(2));
  for (const p of [[4, 1, 0, 1, 2, -0.5, 0, -0.5, 1], [9, 0, 0, 0, 1, 0, 0, 0, 0.1], [1, 0, 0, 0, 1, 0, 0, 0, 0.01]]) {
    const root = new Float64Array(9);
    cholesky(p, 3, root);
    const bound = normBound(p);
    let within = 0;
    const n = 100000;
    for (let i = 0; i < n; ++i) {
      const z = [gauss(), gauss(), gauss()];
      const e = [0, 1, 2].map((k) => root[3 * k] * z[0] + root[3 * k + 1] * z[1] + root[3 * k + 2] * z[2]);
      if (Math.hypot(...e) <= bound) ++within;
    }
    assert.ok(Math.abs(within / n - BOUND_SHARE) < 0.0012, `${within / n}`);
  }
});

test("eigenvectors of a symmetric matrix", () => {
  const matrix = [4, 1, 0, 1, 3, -1, 0, -1, 2];
  const { values, vectors } = eigenOf(matrix, 3);
  assert.ok(values[0] >= values[1] && values[1] >= values[2]);
  close(values.reduce((x, y) => x + y), 9, 1e-12);
  vectors.forEach((v, k) => {
    for (let i = 0; i < 3; ++i) {
      const image = matrix[3 * i] * v[0] + matrix[3 * i + 1] * v[1] + matrix[3 * i + 2] * v[2];
      assert.ok(Math.abs(image - values[k] * v[i]) < 1e-12);
    }
  });
});
