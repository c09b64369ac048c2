// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A run of which all is known: errors in units of sigma, hypotheses that are born, merge and are dropped.
import { normal, uniform } from "../src/mixture/sample.ts";
import type { JsonObject } from "../src/payload.ts";
import { packTrace, type TraceJson } from "./pack.ts";

export const FRAMES = 400;
/** Two frames a second. */
export const STEP_S = 0.5;
/** The sigmas that the run states [m], and by how much its errors along x, y, z are larger. */
export const SIGMA_M = 0.002;
export const FACTORS = [1, 2, 0.4];
/** Frames of the second hypothesis, which is turned by half a turn about z, and of the third, which merges into the first. */
export const TURNED = { first: 40, last: 299, id: 7 };
export const MERGED = { first: 100, last: 149, id: 8 };
/** In these the cup's leading hypothesis is the turned one, and wrong. */
export const WRONG = { first: 60, last: 79 };

type Pose = number[];
const about = (angle: number) => [0, 0, Math.sin(angle / 2), Math.cos(angle / 2)];
const within = (frame: number, { first, last }: { first: number; last: number }) => frame >= first && frame <= last;
const frames = <T>(make: (frame: number) => T) => Array.from({ length: FRAMES }, (_, frame) => make(frame));

/** The hypotheses of the cup at a frame. */
export function hypothesesAt(frame: number): { id: number; probability: number; pose: Pose }[] {
  const turned = within(frame, TURNED);
  const merged = within(frame, MERGED);
  const second = turned ? (within(frame, WRONG) ? 0.55 : 0.25) : 0;
  const third = merged ? 0.1 : 0;
  return [
    { id: 3, probability: 0.98 - second - third, pose: [0.2, 0.1, 0, ...about(0.3)] },
    ...(turned ? [{ id: TURNED.id, probability: second, pose: [0.21, 0.1, 0, ...about(0.3 + Math.PI)] }] : []),
    ...(merged ? [{ id: MERGED.id, probability: third, pose: [0.2, 0.13, 0, ...about(0.4)] }] : []),
  ];
}

function part(truth: Pose[], gauss: () => number, hasTruth: boolean): TraceJson["camera"] {
  const noisy = truth.map((pose) => {
    const turn = about(0.002 * gauss());
    const [z, w] = [pose[5] * turn[3] + pose[6] * turn[2], pose[6] * turn[3] - pose[5] * turn[2]];
    return [...FACTORS.map((factor, i) => pose[i] + factor * SIGMA_M * gauss()), 0, 0, z, w];
  });
  const variance = SIGMA_M ** 2;
  return {
    pose: noisy, sd: frames(() => [0.002, 0.002, 0.002, SIGMA_M, SIGMA_M, SIGMA_M]), truth: hasTruth ? truth : null,
    position_covariance: frames(() => [variance, 0, 0, variance, 0, variance]),
    ...(hasTruth ? { nees: frames((frame) => (frame % 20 === 0 ? 30 : 6)) } : {}),
  };
}

export function riverTrace(hasTruth = true): TraceJson {
  const gauss = normal(uniform(4));
  const still = frames(() => [0.2, 0.1, 0, ...about(0.3)]);
  const camera = part(frames((k) => [0.3 * Math.cos(k / 60), 0.3 * Math.sin(k / 60), 1, ...about(k / 60)]), gauss, hasTruth);
  const cup = part(still, gauss, hasTruth);
  // A wrong mode: half a turn off, and nothing else.
  for (let k = WRONG.first; k <= WRONG.last; ++k) cup.pose[k] = [0.21, 0.1, 0, ...about(0.3 + Math.PI)];
  const box = part(frames(() => [-0.2, 0.1, 0, ...about(0)]), gauss, hasTruth);
  const object = (own: TraceJson["camera"], alternatives: ReturnType<typeof hypothesesAt>[]) => ({
    world: own, relative: own, alternatives, detection: own.pose.map((pose, k) => (k % 5 === 4 ? null : pose && pose.map((value, i) => (i < 3 ? value + 0.004 * gauss() : value)))),
    status: frames((k) => (k === 0 ? "started" : k % 5 === 4 ? "none" : k === 201 ? "gated" : "used")),
    mode_probability: frames((k) => Math.max(...(alternatives[k].length > 0 ? alternatives[k] : [{ probability: 0.995 }]).map(({ probability }) => probability))),
    nis: frames((k) => (k % 5 === 4 || k === 0 || k === 201 ? null : k % 10 === 1 ? 20 : 5)),
  });
  return {
    name: "river", method: "multi-object", frames: FRAMES, stamps_s: frames((k) => 100 + STEP_S * k), order: ["box", "cup"], camera,
    objects: { box: object(box, frames(() => [])), cup: object(cup, frames(hypothesesAt)) }, hypotheses: frames(() => []),
  };
}

export function riverReport(trace: TraceJson = riverTrace()): JsonObject {
  return { schema: 1, type: "posemix.report", kind: "slam", title: "river", program: "", documents: {}, trace: packTrace(trace) as unknown as JsonObject };
}
