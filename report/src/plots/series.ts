// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The series in the plots of a run, computed from its trace.
import { covarianceOf } from "../math/linear.ts";
import { normBound } from "../math/norm_bound.ts";
import { angleBetween, DEGREES, log, multiplyInverse, rollPitchYaw, rotationVector, unwrap } from "../math/rotation.ts";
import type { Estimate, PoseTrack } from "../trace/trace.ts";
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

/** What can be read of a pose frame by frame. */
export type TrackView = Pick<PoseTrack, "has" | "position" | "quaternion">;

/** Angle [deg] and distance [mm] between two tracks in frames that have both. */
export function errorNorms(track: TrackView, truth: TrackView, frames: number): { angle: Values; distance: Values } {
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

/** Truth minus estimate: R_true R_est^T, as a vector or as angles [deg], and the difference of the positions [mm], by axis. */
export function errorComponents(track: PoseTrack, truth: PoseTrack, frames: number, as: RotationAs = "vector"): PoseSeries {
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
    if (as === "vector") log(q, e);
    else rollPitchYaw(q, e);
    for (let i = 0; i < 3; ++i) {
      series.rotation[i][frame] = e[i] * DEGREES;
      series.position[i][frame] = 1000 * (t[i] - p[i]);
    }
  }
  return series;
}

/** Standard deviations by axis, in degrees and millimetres, and what the norms of consistent errors do not exceed. */
export interface Spread extends PoseSeries {
  angle: Values;
  distance: Values;
}

export function spreadOf(estimate: Estimate, frames: number): Spread {
  const out = { position: three(frames), rotation: three(frames), angle: blank(frames), distance: blank(frames) };
  const sd = [0, 0, 0];
  const none = [0, 0, 0];
  const p = new Float64Array(9);
  for (let frame = 0; frame < frames; ++frame) {
    if (!estimate.pose.has(frame)) continue;
    if (estimate.hasSd) {
      estimate.rotationSd(frame, sd);
      for (let i = 0; i < 3; ++i) out.rotation[i][frame] = sd[i] * DEGREES;
      covarianceOf(sd, none, p);
      out.angle[frame] = normBound(p) * DEGREES;
    }
    if (estimate.hasPositionSd) {
      estimate.positionSdAt(frame, sd);
      for (let i = 0; i < 3; ++i) out.position[i][frame] = 1000 * sd[i];
      if (estimate.hasCovariance) estimate.covariance(frame, p);
      else covarianceOf(sd, none, p);
      out.distance[frame] = 1000 * normBound(p);
    }
  }
  return out;
}

export const times = (values: Values, factor: number): Values => values.map((value) => (value === null ? null : factor * value));

/** The values of a function of the frame. */
export function valuesOf(frames: number, at: (frame: number) => number | undefined): Values {
  return Array.from({ length: frames }, (_, frame) => at(frame) ?? null);
}

function sizeAt(values: Values, share: number): number {
  const sizes = Float64Array.from(values.filter((value) => value !== null), Math.abs).sort();
  return sizes.length > 0 ? sizes[Math.floor(share * (sizes.length - 1))] : 0;
}

/** How many times the range of the lines the sigmas, and the detections, may take of the picture. */
const MOST_SPREAD = 4;
const MOST_DOTS = 2.5;
/** Of Gaussian values these are about 4 sigma; detections of another mode are farther out. */
const MOST_MEDIANS = 6;

/**
 * A range for lines: it holds all but a hundredth of their values. Sigmas and detections widen it only so far that the
 * lines remain to be seen; what is beyond is marked at the edge.
 */
export function usualRange(series: ChartSeries[], fromZero: boolean): [number, number] {
  let [lines, areas, dots] = [0, 0, 0];
  for (const { values, kind, quiet } of series) {
    if (kind === "dots") dots = quiet ? dots : Math.max(dots, Math.min(sizeAt(values, 0.99), MOST_MEDIANS * sizeAt(values, 0.5)));
    else if (kind === "shade" || kind === "band") areas = Math.max(areas, sizeAt(values, 0.9));
    else lines = Math.max(lines, sizeAt(values, 0.99));
  }
  // Without lines the dots are the subject.
  const subject = lines > 0 ? lines : dots;
  let top = subject > 0 ? Math.max(subject, Math.min(areas, MOST_SPREAD * subject)) : areas;
  top = Math.max(top, Math.min(dots, MOST_DOTS * top));
  top = top > 0 ? 1.15 * top : 1;
  return [fromZero ? 0 : -top, top];
}
