// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import assert from "node:assert/strict";
import { test } from "node:test";
import { DEGREES } from "../../src/math/rotation.ts";
import { positionCovariance, readMixture, rotationSd } from "../../src/mixture/mixture.ts";
import { sampleMixture } from "../../src/mixture/sample.ts";
import { anglesOf, histogram } from "../../src/mixture/marginal.ts";
import { mug, projected } from "../documents.ts";

const close = (actual: number, expected: number, tolerance: number) =>
  assert.ok(Math.abs(actual - expected) <= tolerance, `${actual} is not ${expected}`);

test("degrees, millimetres and translation first are converted", () => {
  const mixture = readMixture("mug.json", mug);
  const turned = readMixture("turned.json", {
    ...mug,
    order: "translation_rotation",
    components: mug["components"].map((component) => ({
      ...component,
      covariance: component.covariance.map((_, i) => component.covariance.map((_, j) => component.covariance[(i + 3) % 6][(j + 3) % 6])),
    })),
  });
  for (const { components } of [mixture, turned]) {
    close(components[0].weight, 0.7, 1e-15);
    close(components[0].translation[2], 0.8, 1e-15);
    close(rotationSd(mixture, components[0])[1] * DEGREES, 3, 1e-12);
    close(Math.sqrt(components[0].covariance[35]), 0.008, 1e-15);
  }
});

test("the distribution is read under the key of the release before, too", () => {
  const { distribution, ...rest } = mug;
  assert.equal(distribution, "concentrated");
  assert.equal(readMixture("old.json", { ...rest, law: distribution }).distribution, "concentrated");
  assert.throws(() => readMixture("old.json", rest), /distribution "undefined" is not known/);
});

test("the position's covariance: body axes are turned, a left one gains the lever arm", () => {
  const right = readMixture("mug.json", mug);
  const p = positionCovariance(right, right.components[1]);
  close(Math.sqrt(p[0]), 0.004, 1e-12);
  close(Math.sqrt(p[8]), 0.008, 1e-12);
  const degree = Math.PI / 180;
  const covariance = Array.from({ length: 6 }, (_, i) => Array.from({ length: 6 }, (_, j) => (i === j ? (i === 2 ? degree ** 2 : 1e-12) : 0)));
  const left = readMixture("left.json", {
    ...mug, side: "left", units: { rotation: "rad", translation: "m" },
    components: [{ weight: 1, mean: { translation: [10, 0, 0], quaternion_xyzw: [0, 0, 0, 1] }, covariance }],
  });
  // One degree about z, ten metres from the origin.
  close(Math.sqrt(positionCovariance(left, left.components[0])[4]), 10 * degree, 1e-5);
});

test("draws have the moments of a concentrated component", () => {
  const mixture = readMixture("mug.json", mug);
  const { positions, components, count } = sampleMixture(mixture, 40000);
  close(components.reduce((sum, k) => sum + k, 0) / count, 0.3, 0.01);
  let [mean, square] = [0, 0];
  for (let i = 0; i < count; ++i) {
    mean += positions[3 * i + 2] / count;
    square += (positions[3 * i + 2] - 0.8) ** 2 / count;
  }
  close(mean, 0.8, 2e-4);
  close(Math.sqrt(square), 0.008, 2e-4);
});

test("draws of a wide projected component follow its distribution, not the Gaussian's", () => {
  const sd = 0.8;
  const mixture = readMixture("wide.json", projected(sd));
  const { quaternions, count } = sampleMixture(mixture, 40000);
  let square = 0;
  for (let i = 0; i < count; ++i) square += (quaternions[4 * i] / quaternions[4 * i + 3]) ** 2 / count;
  // E[u_x^2] under N(u) (1 + u.u)^-2, by the trapezoidal rule over the radius.
  let [mass, moment] = [0, 0];
  for (let r = 0; r < 8; r += 1e-3) {
    const weight = r * r * Math.exp((-r * r) / (2 * sd * sd)) / (1 + r * r) ** 2;
    mass += weight;
    moment += (weight * r * r) / 3;
  }
  close(square, moment / mass, 0.01);
  assert.ok(moment / mass < 0.5 * sd * sd);
});

test("the marginal angle: shares of the components, half a turn apart", () => {
  const mixture = readMixture("mug.json", mug);
  const samples = sampleMixture(mixture, 20000);
  for (const frame of ["body", "reference"] as const) {
    const angles = anglesOf(mixture, samples, 2, frame);
    const far = angles.filter((angle) => Math.abs(angle) > 90).length / samples.count;
    close(far, 0.3, 0.015);
    const near = Array.from(angles).filter((angle) => Math.abs(angle) < 90);
    close(Math.sqrt(near.reduce((sum, angle) => sum + angle * angle, 0) / near.length), 3, 0.1);
    const { x, density } = histogram(angles, samples.components, 2, 60);
    close(density[0].reduce((sum, value) => sum + value, 0) * (x[1] - x[0]), 1, 1e-9);
    density[0].forEach((value, i) => close(value, density[1][i] + density[2][i], 1e-12));
  }
});

test("mixtures that are wrong are refused by name", () => {
  assert.throws(() => readMixture("a.json", { ...mug, distribution: "wrapped" }), /a\.json: the distribution "wrapped"/);
  assert.throws(() => readMixture("a.json", { ...mug, schema: 2 }), /schema 2/);
  assert.throws(() => readMixture("a.json", { ...mug, components: [] }), /components/);
  assert.throws(() => readMixture("a.json", { ...mug, components: [{ ...mug["components"][0], covariance: [[1]] }] }), /six rows/);
});
