// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The series in the plots of a run, computed from its trace.
import { covarianceOf, largestEigenvalue } from "../math/linear.ts";
import { angleBetween, DEGREES, log, multiplyInverse, rollPitchYaw, rotationVector, unwrap } from "../math/rotation.ts";
import type { Estimate, PoseTrack, Trace } from "../trace/trace.ts";
import type { ChartSeries, Values } from "./chart.ts";

export type RotationAs = "vector" | "rpy";
export const ROTATION_NAMES: Record<RotationAs, string[]> = {
  vector: ["rotation vector x", "rotation vector y", "rotation vector z"],
  rpy: ["roll", "pitch", "yaw"],
};

export const blank = (frames: number): Values => new Array<number | null>(frames).fill(null);
const three = (frames: number): Values[] => [blank(frames), blank(frames), blank(frames)];

/** Position in metres and rotation in degrees, three components each. */
export interface PoseSeries {
  position: Values[];
  rotation: Values[];
}

/**
 * A track for plots. Quaternions have the sign nearest to the previous frame (to `beside`, if given), so that lines jump
 * only where the rotation does.
 */
export function poseSeries(track: PoseTrack, frames: number, as: RotationAs, beside?: PoseSeries): PoseSeries {
  const series = { position: three(frames), rotation: three(frames) };
  const p = [0, 0, 0];
  const q = [0, 0, 0, 1];
  const last = [0, 0, 0, 1];
  const r = [0, 0, 0];
  const near = [0, 0, 0];
  let started = false;
  for (let frame = 0; frame < frames; ++frame) {
    if (beside && beside.rotation[0][frame] !== null) {
      for (let i = 0; i < 3; ++i) near[i] = beside.rotation[i][frame]! / DEGREES;
      started = true;
    }
    if (!track.has(frame)) continue;
    track.position(frame, p);
    track.quaternion(frame, q);
    if (as === "vector") nearestVector(q, last, near, beside !== undefined && started, r);
    else rollPitchYaw(q, r);
    for (let i = 0; i < 3; ++i) {
      if (as === "rpy" && started) r[i] = unwrap(r[i], near[i]);
      series.position[i][frame] = p[i];
      series.rotation[i][frame] = r[i] * DEGREES;
      if (!beside) near[i] = r[i];
    }
    started = true;
  }
  return series;
}

function nearestVector(q: number[], last: number[], near: number[], beside: boolean, out: number[]): void {
  const flip = () => {
    for (let i = 0; i < 4; ++i) q[i] = -q[i];
  };
  if (!beside) {
    if (q[0] * last[0] + q[1] * last[1] + q[2] * last[2] + q[3] * last[3] < 0) flip();
    for (let i = 0; i < 4; ++i) last[i] = q[i];
    rotationVector(q, out);
    return;
  }
  const distance = () => Math.hypot(out[0] - near[0], out[1] - near[1], out[2] - near[2]);
  rotationVector(q, out);
  const here = distance();
  flip();
  rotationVector(q, out);
  if (distance() < here) return;
  flip();
  rotationVector(q, out);
}

/** Angle [deg] and distance [mm] between two tracks in frames that have both. */
export function errorNorms(track: PoseTrack, truth: PoseTrack, frames: number): { angle: Values; distance: Values } {
  const [angle, distance] = [blank(frames), blank(frames)];
  const [p, t] = [[0, 0, 0], [0, 0, 0]];
  const [q, r] = [[0, 0, 0, 1], [0, 0, 0, 1]];
  for (let frame = 0; frame < frames; ++frame) {
    if (!track.has(frame) || !truth.has(frame)) continue;
    track.position(frame, p);
    truth.position(frame, t);
    track.quaternion(frame, q);
    truth.quaternion(frame, r);
    angle[frame] = angleBetween(q, r) * DEGREES;
    distance[frame] = 1000 * Math.hypot(p[0] - t[0], p[1] - t[1], p[2] - t[2]);
  }
  return { angle, distance };
}

/** Truth minus estimate: Log(R_true R_est^T) [deg] and the difference of the positions [mm], by axis. */
export function errorComponents(track: PoseTrack, truth: PoseTrack, frames: number): PoseSeries {
  const series = { position: three(frames), rotation: three(frames) };
  const [p, t, e] = [[0, 0, 0], [0, 0, 0], [0, 0, 0]];
  const [q, r] = [[0, 0, 0, 1], [0, 0, 0, 1]];
  for (let frame = 0; frame < frames; ++frame) {
    if (!track.has(frame) || !truth.has(frame)) continue;
    track.position(frame, p);
    truth.position(frame, t);
    track.quaternion(frame, q);
    truth.quaternion(frame, r);
    multiplyInverse(r, q, q);
    log(q, e);
    for (let i = 0; i < 3; ++i) {
      series.rotation[i][frame] = e[i] * DEGREES;
      series.position[i][frame] = 1000 * (t[i] - p[i]);
    }
  }
  return series;
}

/** Three standard deviations by axis, in degrees and millimetres, and of the least certain direction. */
export function threeSigma(estimate: Estimate, frames: number): PoseSeries & { angle: Values; distance: Values } {
  const out = { position: three(frames), rotation: three(frames), angle: blank(frames), distance: blank(frames) };
  const sd = [0, 0, 0];
  const p = new Float64Array(9);
  for (let frame = 0; frame < frames; ++frame) {
    if (!estimate.pose.has(frame)) continue;
    if (estimate.hasSd) {
      estimate.rotationSd(frame, sd);
      for (let i = 0; i < 3; ++i) out.rotation[i][frame] = 3 * sd[i] * DEGREES;
      out.angle[frame] = 3 * Math.max(sd[0], sd[1], sd[2]) * DEGREES;
    }
    if (estimate.hasPositionSd) {
      estimate.positionSdAt(frame, sd);
      for (let i = 0; i < 3; ++i) out.position[i][frame] = 3000 * sd[i];
      if (estimate.hasCovariance) estimate.covariance(frame, p);
      else covarianceOf(sd, [0, 0, 0], p);
      out.distance[frame] = 3000 * Math.sqrt(largestEigenvalue(p));
    }
  }
  return out;
}

export const negative = (values: Values): Values => values.map((value) => (value === null ? null : -value));

/** The probability in every slot of an object, with a gap where another hypothesis takes over the slot. */
export function hypothesisSeries(trace: Trace, object: number): Values[] {
  return trace.objects[object].hypotheses.map((slot) => {
    const values = blank(trace.frames);
    for (let frame = 0; frame < trace.frames; ++frame) {
      if (!slot.pose.has(frame)) continue;
      const taken = frame > 0 && slot.pose.has(frame - 1) && slot.id(frame) !== slot.id(frame - 1);
      if (!taken) values[frame] = slot.probability(frame);
    }
    return values;
  });
}

/** A limit that holds nine tenths of the detections and of the shade, and all but a hundredth of the errors. */
export function usualRange(series: ChartSeries[], fromZero: boolean): [number, number] {
  let top = 0;
  for (const { values, kind } of series) {
    const sizes = values.filter((value) => value !== null).map((value) => Math.abs(value!)).sort((a, b) => a - b);
    if (sizes.length > 0) top = Math.max(top, sizes[Math.floor((kind === undefined ? 0.99 : 0.9) * (sizes.length - 1))]);
  }
  top = top > 0 ? 1.2 * top : 1;
  return [fromZero ? 0 : -top, top];
}
