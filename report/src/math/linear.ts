// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Small symmetric matrices, row by row.
import type { Numbers } from "./rotation.ts";

/**
 * L with L L^T = P for an n x n symmetric P. Directions without variance give zero columns, so that a singular
 * covariance, or one with rounding errors, still has a root.
 */
export function cholesky(p: Numbers, n: number, out: Numbers): void {
  for (let i = 0; i < n; ++i) {
    for (let j = 0; j < n; ++j) {
      if (j > i) {
        out[i * n + j] = 0;
        continue;
      }
      let sum = p[i * n + j];
      for (let k = 0; k < j; ++k) sum -= out[i * n + k] * out[j * n + k];
      if (i === j) out[i * n + i] = Math.sqrt(Math.max(sum, 0));
      else out[i * n + j] = out[j * n + j] > 1e-9 * Math.sqrt(p[i * n + i]) ? sum / out[j * n + j] : 0;
    }
  }
}

/** The 3x3 covariance of standard deviations and the correlations xy, xz, yz. */
export function covarianceOf(sd: Numbers, correlation: Numbers, out: Numbers): void {
  for (let i = 0; i < 3; ++i) out[4 * i] = sd[i] * sd[i];
  out[1] = out[3] = correlation[0] * sd[0] * sd[1];
  out[2] = out[6] = correlation[1] * sd[0] * sd[2];
  out[5] = out[7] = correlation[2] * sd[1] * sd[2];
}

/** The largest eigenvalue of a symmetric 3x3 matrix, by its characteristic polynomial. */
export function largestEigenvalue(p: Numbers): number {
  const mean = (p[0] + p[4] + p[8]) / 3;
  const off = p[1] * p[1] + p[2] * p[2] + p[5] * p[5];
  const [a, b, c] = [p[0] - mean, p[4] - mean, p[8] - mean];
  const radius = Math.sqrt((a * a + b * b + c * c + 2 * off) / 6);
  if (radius < 1e-300) return mean;
  const determinant = a * (b * c - p[5] * p[5]) - p[1] * (p[1] * c - p[5] * p[2]) + p[2] * (p[1] * p[5] - b * p[2]);
  const cosine = Math.max(-1, Math.min(1, determinant / (2 * radius ** 3)));
  return mean + 2 * radius * Math.cos(Math.acos(cosine) / 3);
}

/** out = A P A^T, all n x n. */
export function congruence(a: Numbers, p: Numbers, n: number): Float64Array {
  const half = new Float64Array(n * n);
  const out = new Float64Array(n * n);
  for (let i = 0; i < n; ++i) {
    for (let j = 0; j < n; ++j) {
      for (let k = 0; k < n; ++k) half[i * n + j] += a[i * n + k] * p[k * n + j];
    }
  }
  for (let i = 0; i < n; ++i) {
    for (let j = 0; j < n; ++j) {
      for (let k = 0; k < n; ++k) out[i * n + j] += half[i * n + k] * a[j * n + k];
    }
  }
  return out;
}
