// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import assert from "node:assert/strict";
import { test } from "node:test";
import { cholesky, congruence, covarianceOf, largestEigenvalue } from "../../src/math/linear.ts";
import {
  angleBetween, log, matrixOf, multiply, multiplyInverse, normalize, quaternionOf, rollPitchYaw, rotate, rotationVector,
  twistAngle, unwrap,
} from "../../src/math/rotation.ts";
import { expPose, normal, uniform } from "../../src/mixture/sample.ts";

function near(actual: ArrayLike<number>, expected: ArrayLike<number>, tolerance = 1e-12): void {
  assert.equal(actual.length, expected.length);
  for (let i = 0; i < actual.length; ++i) {
    assert.ok(Math.abs(actual[i] - expected[i]) <= tolerance, `${Array.from(actual)} is not ${Array.from(expected)}`);
  }
}

const random = normal(uniform(3));
const someQuaternion = () => {
  const q = [random(), random(), random(), random()];
  normalize(q);
  return q;
};

test("90 degrees about z is 0 0 0.707107 0.707107", () => {
  const q = [0, 0, 0, 0];
  quaternionOf([0, 0, Math.PI / 2], q);
  near(q, [0, 0, Math.SQRT1_2, Math.SQRT1_2]);
  const v = [0, 0, 0];
  rotate(q, [1, 0, 0], v);
  near(v, [0, 1, 0]);
});

test("Log undoes Exp, from no angle at all to pi", () => {
  for (const angle of [0, 1e-12, 1e-7, 1e-4, 0.3, 3, Math.PI - 1e-9]) {
    const v = [angle * 0.6, 0, angle * 0.8];
    const q = [0, 0, 0, 1];
    const back = [0, 0, 0];
    quaternionOf(v, q);
    log(q, back);
    near(back, v, 1e-9 * Math.max(angle, 1e-6));
    log(q.map((value) => -value), back);
    near(back, v, 1e-9 * Math.max(angle, 1e-6));
  }
});

test("the rotation vector of -q goes the other way round", () => {
  const q = [0, 0, Math.sin(0.5), Math.cos(0.5)];
  const v = [0, 0, 0];
  rotationVector(q, v);
  near(v, [0, 0, 1]);
  rotationVector(q.map((value) => -value), v);
  near(v, [0, 0, 1 - 2 * Math.PI], 1e-12);
});

test("products, inverses and matrices agree", () => {
  for (let n = 0; n < 50; ++n) {
    const [a, b] = [someQuaternion(), someQuaternion()];
    const v = [random(), random(), random()];
    const [ab, back] = [[0, 0, 0, 0], [0, 0, 0, 0]];
    multiply(a, b, ab);
    multiplyInverse(ab, b, back);
    near(back, a);
    const [once, twice, at] = [[0, 0, 0], [0, 0, 0], [0, 0, 0]];
    rotate(ab, v, once);
    rotate(b, v, twice);
    rotate(a, twice, twice);
    near(once, twice);
    const m = new Float64Array(9);
    matrixOf(ab, m);
    for (let i = 0; i < 3; ++i) at[i] = m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2];
    near(at, once);
    const r = [0, 0, 0];
    log(back, r);
    assert.ok(Math.abs(angleBetween(ab, b) - Math.hypot(...logOf(ab, b))) < 1e-9);
  }
});

function logOf(a: number[], b: number[]): number[] {
  const [q, r] = [[0, 0, 0, 1], [0, 0, 0]];
  multiplyInverse(a, b, q);
  log(q, r);
  return r;
}

test("roll, pitch and yaw make the rotation again", () => {
  for (let n = 0; n < 20; ++n) {
    const q = someQuaternion();
    const angles = [0, 0, 0];
    rollPitchYaw(q, angles);
    const [x, y, z] = [[0, 0, 0, 1], [0, 0, 0, 1], [0, 0, 0, 1]];
    quaternionOf([angles[0], 0, 0], x);
    quaternionOf([0, angles[1], 0], y);
    quaternionOf([0, 0, angles[2]], z);
    multiply(z, y, z);
    multiply(z, x, z);
    assert.ok(angleBetween(z, q) < 1e-7);
  }
});

test("the twist of a turn about an axis is its angle, a tilt before it aside", () => {
  const [turn, tilt] = [[0, 0, 0, 1], [0, 0, 0, 1]];
  quaternionOf([0, 0, 2.5], turn);
  quaternionOf([0.4, 0, 0], tilt);
  multiply(turn, tilt, turn);
  assert.ok(Math.abs(twistAngle(turn, [0, 0, 1]) - 2.5) < 1e-12);
  assert.ok(Math.abs(twistAngle(turn.map((value) => -value), [0, 0, 1]) - 2.5) < 1e-12);
});

test("unwrapping goes to the nearest multiple of a turn", () => {
  near([unwrap(-3.1, 3.1), unwrap(0.1, 12.6)], [-3.1 + 2 * Math.PI, 0.1 + 4 * Math.PI]);
});

test("Exp([0, 0, pi/2, 1, 0, 0]) translates by (0.636620, 0.636620, 0)", () => {
  const [q, t] = [[0, 0, 0, 1], [0, 0, 0]];
  expPose([0, 0, Math.PI / 2, 1, 0, 0], q, t);
  near(t, [0.63662, 0.63662, 0], 1e-6);
  expPose([0, 0, 1e-9, 1, 2, 3], q, t);
  near(t, [1, 2, 3], 1e-8);
});

test("the root of a covariance maps the ball onto its ellipsoid", () => {
  const p = new Float64Array(9);
  covarianceOf([0.1, 0.2, 0.3], [0.5, -0.3, 0.2], p);
  const root = new Float64Array(9);
  cholesky(p, 3, root);
  near(congruence(root, [1, 0, 0, 0, 1, 0, 0, 0, 1], 3), p, 1e-15);
  // Flat and empty covariances have a root too.
  cholesky([1, 1, 0, 1, 1, 0, 0, 0, 0], 3, root);
  near(root, [1, 0, 0, 1, 0, 0, 0, 0, 0]);
});

test("the largest eigenvalue", () => {
  assert.ok(Math.abs(largestEigenvalue([4, 0, 0, 0, 9, 0, 0, 0, 1]) - 9) < 1e-12);
  assert.ok(Math.abs(largestEigenvalue([2, 0, 0, 0, 2, 0, 0, 0, 2]) - 2) < 1e-12);
  // [2 1 0; 1 2 0; 0 0 1] has 3, 1 and 1.
  assert.ok(Math.abs(largestEigenvalue([2, 1, 0, 1, 2, 0, 0, 0, 1]) - 3) < 1e-12);
});
