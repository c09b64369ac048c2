// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import assert from "node:assert/strict";
import { test } from "node:test";
import { deflateSync } from "node:zlib";
import { BadPayload, type ColumnHead, type PackedTrace } from "../../src/payload.ts";
import { decodeColumns, decodeComponent } from "../../src/trace/decode.ts";
import { readTrace, Trace } from "../../src/trace/trace.ts";
import { encodeComponent, TraceWriter } from "../encode.ts";
import { assignSlots } from "../pack.ts";
import { syntheticTrace } from "../synthetic.ts";

const LIMITS = {
  uint8: [0, 255], uint16: [0, 65535], int16: [-32768, 32767], int32: [-2147483648, 2147483647],
} as const;

function head(type: ColumnHead["type"], fold: boolean): ColumnHead {
  return { name: "x", width: 1, type, scale: 1, map: "linear", fold };
}

for (const type of ["uint8", "uint16", "int16", "int32"] as const) {
  for (const fold of [false, true]) {
    test(`${type} reads back to the last bit, differences that wrap included (fold: ${fold})`, () => {
      const [low, high] = LIMITS[type];
      const values = [0, high, low, high, 7, 7, 8, low, 0, 1, high, high - 1];
      const size = { uint8: 1, uint16: 2, int16: 2, int32: 4 }[type];
      const bytes = new Uint8Array(3 + size * values.length);
      encodeComponent(values, head(type, fold), bytes.subarray(3), 0);
      assert.deepEqual(Array.from(decodeComponent(bytes, 3, values.length, head(type, fold))), values);
    });
  }
}

test("byte planes are as the format says: 1, then 257 more, in uint16", () => {
  // Differences 1 and 257 = 0x0101: low bytes 1, 1; high bytes 0, 1.
  const planes = new Uint8Array([1, 1, 0, 1]);
  assert.deepEqual(Array.from(decodeComponent(planes, 0, 2, head("uint16", false))), [1, 258]);
});

test("folded differences are as the format says: -1, then 2 more, in int16", () => {
  // -1 is stored as 1, 2 as 4.
  assert.deepEqual(Array.from(decodeComponent(new Uint8Array([1, 4, 0, 0]), 0, 2, head("int16", true))), [-1, 1]);
});

function packed(columns: ColumnHead[], bytes: Uint8Array, frames = 2): PackedTrace {
  return {
    name: "", method: "", order: [], frames, stamps_s: [0, 1].slice(0, frames), columns,
    data: deflateSync(bytes).toString("base64"),
  };
}

test("exp columns give the exponential", async () => {
  const columns = await decodeColumns(packed([{ ...head("int16", false), scale: 1e-3, map: "exp" }], new Uint8Array([0, 232, 0, 3])));
  assert.equal(columns.get("x")!.value(0, 0), 1);
  assert.ok(Math.abs(columns.get("x")!.value(0, 1) - Math.E) < 1e-12);
});

test("data that are too short, too long, damaged or unknown are refused with a reason", async () => {
  const column = head("int16", false);
  await assert.rejects(decodeColumns(packed([column], new Uint8Array(3))), /has 3 bytes, its columns say 4/);
  await assert.rejects(decodeColumns(packed([column], new Uint8Array(5))), /longer than its columns say/);
  await assert.rejects(decodeColumns({ ...packed([column], new Uint8Array(4)), data: "AAAA" }), /cannot be unpacked/);
  await assert.rejects(decodeColumns({ ...packed([column], new Uint8Array(4)), data: "!" }), /base64/);
  const strange = { ...column, type: "toString" as unknown as "int16" };
  await assert.rejects(decodeColumns(packed([strange], new Uint8Array(4))), BadPayload);
});

test("a missing entry is missing, and poses read back to the quantum", async () => {
  const writer = new TraceWriter(3);
  writer.add({ name: "camera/mask", width: 1, type: "uint8", scale: 1, map: "linear" }, [[1, 0, 1]]);
  const half = Math.SQRT1_2;
  writer.addPoses("camera", [[1, -2, 0.123456, 0, 0, half, half], null, [3, 2, 1, 0, 0, -half, -half]]);
  const trace = await readTrace(writer.packed({ name: "t", method: "m", order: [], stamps_s: [5, 6, 8] }));
  const pose = trace.camera!.pose;
  assert.deepEqual([0, 1, 2].map((frame) => pose.has(frame)), [true, false, true]);
  const [p, q] = [[0, 0, 0], [0, 0, 0, 0]];
  pose.position(0, p);
  assert.ok(p.every((value, i) => Math.abs(value - [1, -2, 0.123456][i]) <= 0.5e-5 + 1e-12), String(p));
  pose.quaternion(2, q);
  // The sign is kept continuous: -q was written as q.
  assert.ok(q.every((value, i) => Math.abs(value - [0, 0, half, half][i]) < 3e-5), String(q));
  assert.equal(trace.camera!.truth, undefined);
  assert.equal(trace.camera!.hasSd, false);
});

test("the frame at a time is the last that is not after it", async () => {
  const trace = new Trace(packed([], new Uint8Array(0)), new Map());
  assert.deepEqual([-1, 0, 0.5, 1, 99].map((seconds) => trace.frameAt(seconds)), [0, 0, 0, 1, 1]);
});

test("a hypothesis keeps its slot while it lives", () => {
  const of = (...ids: number[]) => ids.map((id) => ({ id, probability: 1 / ids.length, pose: [0, 0, 0, 0, 0, 0, 1] }));
  const slots = assignSlots([of(1, 2), of(2, 3), of(2), of(4, 2)]);
  assert.deepEqual(slots.map((slot) => slot.map((entry) => entry?.id ?? null)), [[1, 3, null, 4], [2, 2, 2, 2]]);
});

test("a synthetic trace has its hypotheses, covariances and statuses", async () => {
  const trace = await readTrace(syntheticTrace({ frames: 40, objects: 3, hypotheses: 4 }));
  assert.equal(trace.objects.length, 3);
  const weights = trace.objects[1].hypotheses.map((slot) => slot.probability(20));
  assert.equal(weights.length, 4);
  assert.ok(Math.abs(weights.reduce((a, b) => a + b) - 1) < 1e-4);
  const covariance = new Float64Array(9);
  const sd = [0, 0, 0];
  trace.objects[0].world!.covariance(10, covariance);
  trace.objects[0].world!.positionSdAt(10, sd);
  assert.ok(Math.abs(covariance[1] / (sd[0] * sd[1]) - 0.5) < 1e-4);
  assert.ok(Math.abs(covariance[8] - sd[2] ** 2) < 1e-15);
  assert.equal(trace.statuses[trace.objects[2].status![0]], "started");
});
