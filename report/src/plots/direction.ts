// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// In which direction the errors of the position are largest against their covariance.
import { eigenOf } from "../math/eigen.ts";
import { cholesky } from "../math/linear.ts";
import type { Estimate } from "../trace/trace.ts";

export interface Direction {
  /** A unit vector. */
  along: [number, number, number];
  /** Root of the mean squared error over the mean variance along it. */
  factor: number;
}

/** x with L^T x = b, for a lower triangle of 3 x 3. */
function solveTransposed(l: Float64Array, b: readonly number[]): [number, number, number] {
  const x: [number, number, number] = [0, 0, 0];
  for (let i = 2; i >= 0; --i) {
    let sum = b[i];
    for (let k = i + 1; k < 3; ++k) sum -= l[3 * k + i] * x[k];
    x[i] = sum / l[4 * i];
  }
  return x;
}

/** L^-1 of a lower triangle of 3 x 3. */
function inverseOf(l: Float64Array): Float64Array {
  const out = new Float64Array(9);
  for (let j = 0; j < 3; ++j) {
    for (let i = j; i < 3; ++i) {
      let sum = i === j ? 1 : 0;
      for (let k = j; k < i; ++k) sum -= l[3 * i + k] * out[3 * k + j];
      out[3 * i + j] = sum / l[4 * i];
    }
  }
  return out;
}

/** The direction u of the largest ratio in E[e e^T] u = ratio E[P] u; undefined without truth or covariances. */
export function worstDirection(estimate: Estimate, frames: number): Direction | undefined {
  const { pose, truth } = estimate;
  if (!truth || !estimate.hasCovariance) return undefined;
  const [p, t, one] = [[0, 0, 0], [0, 0, 0], new Float64Array(9)];
  const [errors, mean] = [new Float64Array(9), new Float64Array(9)];
  let count = 0;
  for (let frame = 0; frame < frames; ++frame) {
    if (!pose.has(frame) || !truth.has(frame)) continue;
    ++count;
    pose.position(frame, p);
    truth.position(frame, t);
    estimate.covariance(frame, one);
    for (let k = 0; k < 9; ++k) {
      const [i, j] = [Math.floor(k / 3), k % 3];
      errors[k] += (t[i] - p[i]) * (t[j] - p[j]);
      mean[k] += one[k];
    }
  }
  const root = new Float64Array(9);
  cholesky(mean, 3, root);
  if (count === 0 || !(root[0] > 0 && root[4] > 0 && root[8] > 0)) return undefined;
  const inverse = inverseOf(root);
  const scaled = new Float64Array(9);
  for (let k = 0; k < 81; ++k) {
    const [i, j, a, b] = [Math.floor(k / 27), Math.floor(k / 9) % 3, Math.floor(k / 3) % 3, k % 3];
    scaled[3 * i + j] += inverse[3 * i + a] * errors[3 * a + b] * inverse[3 * j + b];
  }
  const { values, vectors } = eigenOf(scaled, 3);
  const along = solveTransposed(root, vectors[0]);
  const size = Math.hypot(...along) * (along[along.reduce((best, value, i) => (Math.abs(value) > Math.abs(along[best]) ? i : best), 0)] < 0 ? -1 : 1);
  return { along: [along[0] / size, along[1] / size, along[2] / size], factor: Math.sqrt(values[0]) };
}
