// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Field } from "../../src/plots/pen.ts";
import { escaped, SvgPen } from "../../src/plots/pen.ts";
import { polylines, wrapped } from "../../src/plots/polyline.ts";
import { axisName, laneAt, livingAt, riverOf, supportOf, weightAt } from "../../src/plots/river.ts";
import { bandsOf } from "../../src/plots/river_bands.ts";
import { hypothesisColour } from "../../src/plots/river_colours.ts";
import { runsOf, spansOf } from "../../src/plots/runs.ts";
import { readTrace } from "../../src/trace/trace.ts";
import { packTrace } from "../pack.ts";
import { FRAMES, hypothesesAt, MERGED, riverTrace, STEP_S, TURNED, WRONG } from "../river_trace.ts";

async function cup() {
  const trace = await readTrace(packTrace(riverTrace()));
  const object = trace.objects[1];
  return { trace, object, river: riverOf(object.hypotheses, trace.frames, true) };
}

test("the life of every hypothesis: birth, end, and what it merged into", async () => {
  const { river } = await cup();
  assert.deepEqual(river.lanes.map(({ id, first, last, end, into }) => ({ id, first, last, end, into })), [
    { id: 3, first: 0, last: FRAMES - 1, end: "alive", into: undefined },
    { id: TURNED.id, first: TURNED.first, last: TURNED.last, end: "dropped", into: undefined },
    { id: MERGED.id, first: MERGED.first, last: MERGED.last, end: "merged", into: 0 },
  ]);
  assert.ok(Math.abs(river.lanes[1].peak - 0.55) < 1e-4);
});

test("weights of lanes are those of the trace at every frame, and so is the stack", async () => {
  const { river } = await cup();
  for (let frame = 0; frame < FRAMES; ++frame) {
    const living = hypothesesAt(frame);
    river.lanes.forEach(({ id }, lane) => {
      const weight = living.find((one) => one.id === id)?.probability ?? 0;
      assert.ok(Math.abs(weightAt(river, lane, frame) - weight) < 1e-4);
    });
  }
  assert.equal(laneAt(river, 120, 0.01), 0);
  assert.equal(laneAt(river, 120, 0.7), 1);
  assert.equal(laneAt(river, 120, 0.95), 2);
  assert.equal(laneAt(river, 120, 0.99), undefined);
  assert.equal(laneAt(river, 10, 0.5), 0);
});

test("at a frame: the heaviest leads, the others by axis, angle and distance from it", async () => {
  const { river } = await cup();
  const [leading, turned, merged] = livingAt(river, 120);
  assert.deepEqual([leading.id, turned.id, merged.id], [3, TURNED.id, MERGED.id]);
  assert.equal(leading.angleDeg, 0);
  assert.ok(Math.abs(turned.angleDeg - 180) < 0.1 && Math.abs(turned.distanceMm - 10) < 0.1);
  assert.equal(axisName(turned.turn), "z");
  assert.ok(Math.abs(merged.angleDeg - 5.73) < 0.05 && Math.abs(merged.distanceMm - 30) < 0.1);
  assert.equal(livingAt(river, WRONG.first)[0].id, TURNED.id);
});

test("names of axes", () => {
  assert.deepEqual([[0, 0, -1], [0.02, 1, 0], [Math.SQRT1_2, 0, Math.SQRT1_2], [0, 0, 0], [0, 0, -Math.PI]].map(axisName), ["-z", "y", "(0.71, 0.00, 0.71)", "", "z"]);
});

test("a detection supports the nearest hypothesis within reach", async () => {
  const { trace, object, river } = await cup();
  // Detections of this run are in the world, so the camera is put there.
  const still = { ...trace, camera: { pose: { has: () => true, position: (_: number, out: number[]) => out.fill(0), quaternion: (_: number, out: number[]) => [0, 0, 0, 1].forEach((v, i) => (out[i] = v)) } } };
  const support = supportOf(river, still as unknown as typeof trace, object);
  for (let frame = 0; frame < FRAMES; ++frame) {
    const expected = frame % 5 === 4 ? -1 : frame >= WRONG.first && frame <= WRONG.last ? 1 : 0;
    if (frame < MERGED.first || frame > MERGED.last) assert.equal(support[frame], expected, `${frame}`);
  }
});

test("bands: one per life, as high as the weight, though a pixel has many frames", async () => {
  const { trace, river } = await cup();
  const end = STEP_S * (FRAMES - 1);
  for (const width of [50, 2000]) {
    const field: Field = { left: 0, top: 0, width, height: 100, pixel: 1, range: [0, end], x: (x) => (x / end) * width, y: (y) => 100 * y };
    const parts = bandsOf(river, trace.seconds, field);
    assert.deepEqual(parts.map(({ lane }) => lane), [0, 1, 2]);
    const [whole, turned, merged] = parts;
    assert.equal(whole.upper[0], 0);
    assert.equal(whole.upper[whole.upper.length - 2], width);
    const middle = merged.upper.length / 4;
    const k = 2 * Math.floor(middle);
    assert.ok(Math.abs(merged.upper[k + 1] - merged.lower[k + 1] - 10) < 0.5);
    assert.ok(Math.abs(turned.lower[0] - (TURNED.first * STEP_S * width) / end) <= 1 + width / FRAMES);
  }
});

test("colours of hypotheses: the first is the object's, neighbours differ, and all are colours", () => {
  assert.equal(hypothesisColour(0, 0), "#aa9117");
  const made = Array.from({ length: 15 }, (_, lane) => hypothesisColour(3, lane));
  assert.equal(new Set(made).size, 15);
  for (const colour of made) assert.match(colour, /^#[0-9a-f]{6}$/);
});

test("a single frame among many is at least three pixels wide, and the worse of two that meet is kept", () => {
  const values = new Uint8Array(10000).fill(2);
  values[5000] = 4;
  values[5010] = 3;
  const runs = runsOf(values);
  assert.equal(runs.length, 5);
  const spans = spansOf(runs, (frame) => frame / 20, 3, (value) => value);
  const narrow = spans.filter(({ value }) => value !== 2);
  assert.deepEqual(narrow.map(({ value }) => value), [4]);
  assert.equal(narrow[0].end - narrow[0].start, 3);
  assert.ok(spans.indexOf(narrow[0]) > spans.findIndex(({ value }) => value === 2), "painted above");
  assert.deepEqual(spansOf(runs, (frame) => frame / 20, 3, () => -1), []);
  assert.deepEqual(spansOf(runs, (frame) => 10 * frame, 3, (value) => value).map(({ value }) => value), [2, 4, 2, 3, 2]);
});

test("texts in SVG are text, whatever they contain", () => {
  assert.equal(escaped('<a href="x">&\u0000'), "&lt;a href=&quot;x&quot;&gt;&amp;\uFFFD");
  const pen = new SvgPen();
  pen.text("</text><script>", 1, 2, '#fff"/><script>');
  assert.ok(!pen.document(10, 10, "<script>").includes("<script>"));
});

test("sentences in a saved plot are wrapped, and lose no word", () => {
  const text = "98 % within 3 sigma (99.7 % expected): overconfident";
  const lines = wrapped(text, 120, (line) => 6 * line.length);
  assert.ok(lines.length > 1 && lines.every((line) => 6 * line.length <= 120));
  assert.equal(lines.join(" "), text);
});

test("lines of many frames are thinned to the lowest and highest value per pixel, with their gaps", () => {
  const n = 20000;
  const x = Float64Array.from({ length: n }, (_, i) => i);
  const values = Array.from(x, (i) => (i === 777 ? 90 : i === 12345 ? -90 : i >= 15000 && i < 15100 ? null : Math.sin(i)));
  const field: Field = { left: 0, top: 0, width: 500, height: 100, pixel: 1, range: [0, n - 1], x: (at) => (at / (n - 1)) * 500, y: (y) => y };
  const lines = polylines(x, values, field);
  assert.equal(lines.length, 2);
  const points = lines.flat();
  assert.ok(points.length < 2 * 2 * 502);
  const ys = points.filter((_, i) => i % 2 === 1);
  assert.equal(Math.max(...ys), 90);
  assert.equal(Math.min(...ys), -90);
  // A part of x: lines reach its edges.
  const part = polylines(x, values, { ...field, range: [100.5, 110.5], x: (at) => 50 * (at - 100.5) }).flat();
  assert.ok(part[0] <= 0 && part[part.length - 2] >= 500);
});
