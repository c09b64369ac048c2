// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import assert from "node:assert/strict";
import { test } from "node:test";
import { Vector3 } from "three";
import { coneMap, MOST_HALF_ANGLE } from "../../src/math/cone.ts";
import { eigen3 } from "../../src/math/principal_axes.ts";
import { PoseSamples } from "../../src/math/pose_samples.ts";
import { log } from "../../src/math/rotation.ts";
import { axisOfInterest } from "../../src/mixture/marginal.ts";
import { readMixture } from "../../src/mixture/mixture.ts";
import { byWeight, componentColours, MOST_COLOURS, REST_COLOUR } from "../../src/mixture/order.ts";
import { normal, sampleMixture, uniform } from "../../src/mixture/sample.ts";
import { exaggerationOf, factorFor } from "../../src/scene/exaggeration.ts";
import { trimmed } from "../../src/scene/extent.ts";
import { nearestImage, readImages } from "../../src/scene/images.ts";
import { cornersOf, imageBox, readIntrinsics, windowOf } from "../../src/scene/lens.ts";
import { legendLines, pictureName, wrapped } from "../../src/scene/picture_text.ts";
import { Placement } from "../../src/scene/placement.ts";
import { axisText, differenceText } from "../../src/scene/tips.ts";
import { lengthText, mmText, roundLength } from "../../src/scene/units.ts";
import { axisName, directionOf, fitOf } from "../../src/scene/views.ts";
import { mug, projected } from "../documents.ts";
import { colourOf } from "../../src/ui/palette.ts";
import { packTrace } from "../pack.ts";
import { FRAMES, LENS, sceneTrace, sdOf } from "../scene_run.ts";
import { readTrace } from "../../src/trace/trace.ts";

const close = (actual: number, expected: number, tolerance: number) =>
  assert.ok(Math.abs(actual - expected) <= tolerance, `${actual} is not ${expected}`);

test("principal axes: the largest first, and the matrix is what they make", () => {
  const p = [4, 1, -0.5, 1, 3, 0.2, -0.5, 0.2, 1];
  const values = [0, 0, 0];
  const v = new Array<number>(9).fill(0);
  eigen3(p, values, v);
  assert.ok(values[0] > values[1] && values[1] > values[2]);
  for (let i = 0; i < 3; ++i) {
    for (let j = 0; j < 3; ++j) {
      close([0, 1, 2].reduce((sum, k) => sum + v[3 * i + k] * values[k] * v[3 * j + k], 0), p[3 * i + j], 1e-12);
      close([0, 1, 2].reduce((sum, k) => sum + v[3 * k + i] * v[3 * k + j], 0), i === j ? 1 : 0, 1e-12);
    }
  }
});

test("a cone: half angles are sigmas of the rotations across the axis, and its own sigma has no part in it", () => {
  const [a, b] = [0.05, 0.1];
  const map = new Array<number>(9).fill(0);
  // About x, y and z; the axis is z, so that turns about y move its tip along x.
  coneMap([0, 0, 1], [a * a, 0, 0, 0, b * b, 0, 0, 0, 4], 3, 2, map);
  const reach = (row: number) => Math.hypot(map[3 * row], map[3 * row + 1]);
  close(reach(0), 2 * Math.tan(3 * b), 1e-9);
  close(reach(1), 2 * Math.tan(3 * a), 1e-9);
  close(map[8], 2, 1e-12);
  coneMap([0, 0, 1], [9, 0, 0, 0, 9, 0, 0, 0, 9], 3, 1, map);
  close(reach(0), Math.tan(MOST_HALF_ANGLE), 1e-9);
  const isCapped = (sd: number) => coneMap([0, 0, 1], [sd * sd, 0, 0, 0, sd * sd, 0, 0, 0, 9], 3, 1, map);
  assert.deepEqual([isCapped(0.1), isCapped(0.5)], [false, true]);
});

/** Mean and covariance of many draws: of position, and of the rotation vector from the mean. */
function moments(samples: PoseSamples, t: number[], count: number): { mean: number[]; position: number[]; turn: number[] } {
  const [p, q] = [[0, 0, 0], [0, 0, 0, 1]];
  const mean = [0, 0, 0];
  const position = new Array<number>(9).fill(0);
  const turn = [0, 0, 0];
  const v = [0, 0, 0];
  for (let i = 0; i < count; ++i) {
    samples.draw(i, t, [0, 0, 0, 1], 1, p, q);
    log(q, v);
    for (let a = 0; a < 3; ++a) {
      mean[a] += p[a] / count;
      turn[a] += v[a] ** 2 / count;
      for (let b = 0; b < 3; ++b) position[3 * a + b] += ((p[a] - t[a]) * (p[b] - t[b])) / count;
    }
  }
  return { mean, position, turn };
}

test("samples have the covariance of the position and the sigmas of the rotation that the trace has", () => {
  const count = 20000;
  const samples = new PoseSamples(count);
  const t = [0.5, -0.2, 1];
  const covariance = [4e-6, 1e-6, 0, 1e-6, 9e-6, -2e-6, 0, -2e-6, 1e-6];
  const sd = [0.002, 0.004, 0.001];
  samples.prepare(t, covariance, sd, [0.003, 0.003, 0.002]);
  const { position, turn } = moments(samples, t, count);
  position.forEach((value, i) => close(value, covariance[i], 3e-7));
  turn.forEach((value, i) => close(value, sd[i] ** 2, 0.04 * sd[i] ** 2));
});

test("a rotation about the frame's origin gives a banana: the samples lie on the arc", () => {
  const samples = new PoseSamples(4000);
  const t = [2, 0, 0];
  const yaw = 0.3;
  const small = 1e-8;
  // The position's error is only the lever arm's, y = phi_z 2 m.
  samples.prepare(t, [small, 0, 0, 0, 4 * yaw * yaw, 0, 0, 0, small], [1e-6, 1e-6, yaw], [1e-4, 1e-4, 1e-4]);
  const { mean } = moments(samples, t, 4000);
  const [p, q] = [[0, 0, 0], [0, 0, 0, 1]];
  for (let i = 0; i < 4000; ++i) {
    samples.draw(i, t, [0, 0, 0, 1], 1, p, q);
    close(Math.hypot(p[0], p[1]), 2, 2e-3);
  }
  close(mean[0], 2 * Math.exp(-0.5 * yaw * yaw), 0.01);
});

test("samples that are drawn larger lie on the same lines from the mean", () => {
  const samples = new PoseSamples(10);
  const t = [1, 0, 0];
  samples.prepare(t, [1e-4, 0, 0, 0, 1e-4, 0, 0, 0, 1e-4], [0.01, 0.01, 0.01], [0.01, 0.01, 0.01]);
  const [p, large, q] = [[0, 0, 0], [0, 0, 0], [0, 0, 0, 1]];
  for (let i = 0; i < 10; ++i) {
    samples.draw(i, t, [0, 0, 0, 1], 1, p, q);
    samples.draw(i, t, [0, 0, 0, 1], 10, large, q);
    for (let k = 0; k < 3; ++k) close(large[k] - t[k], 10 * (p[k] - t[k]), 1e-12);
  }
});

test("labels: none over another, all in the picture, and those without room are refused", () => {
  const random = uniform(3);
  const gauss = normal(random);
  const placement = new Placement();
  placement.begin(600, 400);
  placement.block(500, 300, 100, 100);
  const boxes: number[][] = [[500, 300, 600, 400]];
  let refused = 0;
  for (let i = 0; i < 60; ++i) {
    const width = 40 + 60 * random();
    const slot = placement.place(300 + 60 * gauss(), 200 + 40 * gauss(), width, 16, -1);
    if (slot < 0) {
      ++refused;
      continue;
    }
    boxes.push([placement.x, placement.y, placement.x + width, placement.y + 16]);
  }
  assert.ok(boxes.length > 15 && refused > 0);
  boxes.forEach((a, i) => {
    assert.ok(a[0] >= 0 && a[1] >= 0 && a[2] <= 600 && a[3] <= 400);
    for (const b of boxes.slice(i + 1)) assert.ok(a[0] >= b[2] || b[0] >= a[2] || a[1] >= b[3] || b[1] >= a[3], "labels overlap");
  });
});

test("a label stays where it was while there is room", () => {
  const placement = new Placement();
  placement.begin(600, 400);
  const slot = placement.place(300, 200, 60, 16, 3);
  assert.equal(slot, 3);
  assert.notEqual(placement.place(300, 200, 60, 16, 3), 3);
});

test("the extent: what runs away is left out, a path that goes far is not", () => {
  const track = (points: number[][]) => points.map(([x, y, z], frame) => ({ frame, point: new Vector3(x, y, z) }));
  const still = track(Array.from({ length: 100 }, (_, i) => [0.001 * (i % 3), 0, i < 3 ? 0.2 : 0]));
  const path = track(Array.from({ length: 100 }, (_, i) => [0.02 * i, 1, 0.5]));
  const lost = track(Array.from({ length: 100 }, (_, i) => [0, i === 50 ? 40 : 0, 0]));
  const [a, b, c] = trimmed([still, path, lost]);
  assert.equal(a.length, 100);
  assert.equal(b.length, 100);
  assert.equal(c.length, 99);
});

test("a fit shows all points, in perspective and without, and not from needlessly far", () => {
  const points = [[0, 0, 0], [2, 0.3, 0.1], [-1, 4, 0.5], [0.3, 1, 3]].map(([x, y, z]) => new Vector3(x, y, z));
  const up = new Vector3(0, 0, 1);
  for (const [view, tangent] of [["fit", 0.4], ["top", 0], ["x", 0]] as const) {
    const from = directionOf(view, up);
    const { centre, distance, half } = fitOf(points, new Vector3(), { from, up, margin: 0, aspect: 1.5, tangent });
    const right = new Vector3().crossVectors(up, from).normalize();
    const above = new Vector3().crossVectors(from, right);
    const shares = points.map((point) => {
      const arm = point.clone().sub(centre);
      const size = tangent > 0 ? (distance - arm.dot(from)) * tangent : half;
      return Math.max(Math.abs(arm.dot(right)) / (1.5 * size), Math.abs(arm.dot(above)) / size);
    });
    assert.ok(Math.max(...shares) <= 1, view);
    assert.ok(Math.max(...shares) > 0.9, view);
  }
});

test("views by name: from above, along axes, and what they are called", () => {
  const up = new Vector3(0, 0, 1);
  close(directionOf("top", up).z, 1, 1e-6);
  close(directionOf("-y", up).y, -1, 1e-6);
  close(directionOf("front", up).y, -1, 1e-6);
  assert.equal(axisName(new Vector3(0, -1, 0)), "-y");
  assert.equal(axisName(new Vector3(0.6, 0.8, 0)), "");
});

test("intrinsics: a pixel of the image lies where the projection puts its ray", () => {
  const [width, height, near] = [900, 500, 0.1];
  const { left, right, top, bottom } = windowOf(LENS, width, height, near);
  const box = imageBox(LENS, width, height);
  close(box.height, 500, 1e-9);
  for (const [u, v] of [[0, 0], [170, 110], [319, 239], [40, 200]]) {
    const [x, y] = [(u - LENS.cx) / LENS.fx, -(v - LENS.cy) / LENS.fy];
    const seen = [((x * near - left) / (right - left)) * width, ((top - y * near) / (top - bottom)) * height];
    const scale = box.width / LENS.width;
    close(seen[0], box.x + scale * (u + 0.5), 1e-9);
    close(seen[1], box.y + scale * (v + 0.5), 1e-9);
  }
  const [corner] = cornersOf(LENS);
  close(corner[0], (-0.5 - LENS.cx) / LENS.fx, 1e-12);
  assert.equal(readIntrinsics(undefined), undefined);
  assert.throws(() => readIntrinsics({ ...LENS, fx: 0 }), /intrinsics/);
  assert.throws(() => readIntrinsics({ ...LENS, cx: "middle" }), /intrinsics/);
});

test("images: the nearest one, and what is none is refused", () => {
  const stamps = [1, 2, 4].map((stamp_s) => ({ stamp_s }));
  assert.deepEqual([0, 1.4, 1.6, 3.1, 9].map((stamp) => nearestImage(stamps, stamp)), [0, 0, 1, 2, 2]);
  assert.equal(nearestImage([], 1), -1);
  assert.throws(() => readImages([{ stamp_s: 1, type: "image/svg+xml", data: "AA==" }]), /images/);
  assert.throws(() => readImages([{ stamp_s: 1, type: "image/png", data: 'x" onerror="' }]), /images/);
});

test("exaggeration: the smallest factor that is enough for the median of the run", async () => {
  assert.deepEqual([0.5, 0.02, 1e-6, 0].map((size) => factorFor(size, 0.1, size, 1)), [1, 10, 100, 1]);
  // What is large at first must not hide the scene.
  assert.equal(factorFor(0.02, 0.1, 0.3, 1), 1);
  const trace = await readTrace(packTrace(sceneTrace()));
  const sizes = Array.from({ length: FRAMES }, (_, frame) => 3 * Math.max(...sdOf(0, frame, false).slice(3))).sort((a, b) => a - b);
  const of = (index: number) => (index === 0 ? trace.objects[0].world : undefined);
  const middle = sizes[FRAMES / 2];
  assert.ok(sizes[0] < 0.75 * middle && sizes[FRAMES - 1] > 1.5 * middle);
  assert.equal(exaggerationOf(trace, of, 0.8 * middle, 9), 1);
  assert.equal(exaggerationOf(trace, of, 1.3 * middle, 9), 10);
  assert.equal(exaggerationOf(trace, of, 1.3 * middle, 5 * sizes[FRAMES - 1]), 1);
});

test("a note that is wider than the picture is broken between words", () => {
  const text = "ellipsoids and cones: 3 sigma, drawn 10 times larger";
  assert.deepEqual(wrapped(text, 100, (part) => part.length), [text]);
  const lines = wrapped(text, 30, (part) => part.length);
  assert.equal(lines.join(" "), text);
  assert.ok(lines.length === 2 && lines.every((line) => line.length <= 30));
});

test("words: lengths, differences and names of files", () => {
  assert.deepEqual([2, 0.5, 0.01, 0.002].map(lengthText), ["2 m", "50 cm", "1 cm", "2 mm"]);
  assert.deepEqual([0.0123, 0.00123, 0.000123].map(mmText), ["12", "1.2", "0.12"]);
  assert.deepEqual([0.7, 0.19, 1].map(roundLength), [0.5, 0.1, 1]);
  assert.equal(axisText([0, 0, -3]), "z");
  assert.equal(differenceText([0, 0, 0], [0, 0, 0, 1], [0.003, 0.004, 0], [0, 0, 1, 0]), "180 deg about z, 5.0 mm");
  assert.equal(pictureName("../evil: <run>/é", 2), "evil-run-e_t2.00s_scene.png");
  assert.equal(pictureName("", 0), "run_t0.00s_scene.png");
  assert.deepEqual(legendLines([50, 60, 40, 90], 120), [[0, 1], [2], [3]]);
});

test("mixtures: by weight, and only the heaviest have colours of their own", () => {
  const one = mug["components"][0];
  const weights = Array.from({ length: 14 }, (_, i) => 1 + ((5 * i) % 14));
  const mixture = readMixture("many.json", { ...mug, components: weights.map((weight) => ({ ...one, weight })) });
  const order = byWeight(mixture);
  assert.deepEqual(order.map((k) => weights[k]), [...weights].sort((a, b) => b - a));
  const colours = componentColours(mixture);
  assert.equal(new Set(order.slice(0, MOST_COLOURS).map((k) => colours[k])).size, MOST_COLOURS);
  assert.ok(order.slice(MOST_COLOURS).every((k) => colours[k] === REST_COLOUR));
  // In a run: the object's own colour and tints of it, none of which is another object's.
  const tints = componentColours({ ...mixture, colour: colourOf(2) });
  assert.equal(tints[order[0]], colourOf(2));
  assert.equal(new Set(order.slice(0, 5).map((k) => tints[k])).size, 5);
  const others = Array.from({ length: 10 }, (_, i) => colourOf(i).toLowerCase()).filter((_, i) => i !== 2);
  assert.ok(tints.every((colour) => !others.includes(colour.toLowerCase())));
});

test("the marginal opens on the axis with peaks, else on the widest", () => {
  const peaks = readMixture("x.json", projected(0.02, [[0, 0, 0, 1], [0.3, 0, 0, 0.954], [-0.3, 0, 0, 0.954]]));
  assert.equal(axisOfInterest(peaks, sampleMixture(peaks, 20000, 2), "body"), 0);
  const component = { ...mug["components"][0], covariance: mug["components"][0].covariance.map((row, i) => row.map((value, j) => (i === 1 && j === 1 ? 25 : value))) };
  const wide = readMixture("y.json", { ...mug, components: [component] });
  assert.equal(axisOfInterest(wide, sampleMixture(wide, 20000, 2), "body"), 1);
});
