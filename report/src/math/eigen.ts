// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Eigenvectors of small symmetric matrices.
import type { Numbers } from "./rotation.ts";

export interface Eigen {
  /** The largest first. */
  values: number[];
  /** Unit vectors, one per value. */
  vectors: number[][];
}

/** One Jacobi rotation in the plane of i and j, which makes the entry there zero. */
function rotatePlane(a: number[], v: number[], n: number, i: number, j: number): void {
  const off = a[i * n + j];
  if (off === 0) return;
  const theta = (a[j * n + j] - a[i * n + i]) / (2 * off);
  const t = (theta >= 0 ? 1 : -1) / (Math.abs(theta) + Math.sqrt(theta * theta + 1));
  const c = 1 / Math.sqrt(t * t + 1);
  const s = t * c;
  const turn = (m: number[], first: number, second: number) => {
    const [x, y] = [m[first], m[second]];
    m[first] = c * x - s * y;
    m[second] = s * x + c * y;
  };
  for (let k = 0; k < n; ++k) turn(a, k * n + i, k * n + j);
  for (let k = 0; k < n; ++k) turn(a, i * n + k, j * n + k);
  for (let k = 0; k < n; ++k) turn(v, k * n + i, k * n + j);
}

/** Eigenvalues and eigenvectors of a symmetric n x n matrix, row by row, by cyclic Jacobi rotations. */
export function eigenOf(matrix: Numbers, n: number): Eigen {
  const a = Array.from(matrix);
  const v = Array.from({ length: n * n }, (_, k) => (k % (n + 1) === 0 ? 1 : 0));
  for (let sweep = 0; sweep < 40; ++sweep) {
    let off = 0;
    let all = 0;
    for (let i = 0; i < n; ++i) {
      for (let j = 0; j < n; ++j) {
        all += a[i * n + j] ** 2;
        if (i !== j) off += a[i * n + j] ** 2;
      }
    }
    if (off <= 1e-30 * all) break;
    for (let i = 0; i < n; ++i) for (let j = i + 1; j < n; ++j) rotatePlane(a, v, n, i, j);
  }
  const order = Array.from({ length: n }, (_, i) => i).sort((i, j) => a[j * n + j] - a[i * n + i]);
  return { values: order.map((i) => a[i * n + i]), vectors: order.map((i) => Array.from({ length: n }, (_, k) => v[k * n + i])) };
}
