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

/** Turns the columns i and j of a matrix of n columns by a plane rotation. */
function turnColumns(m: Numbers, n: number, i: number, j: number, c: number, s: number): void {
  for (let k = 0; k < n; ++k) {
    const [x, y] = [m[k * n + i], m[k * n + j]];
    m[k * n + i] = c * x - s * y;
    m[k * n + j] = s * x + c * y;
  }
}

function turnRows(m: Numbers, n: number, i: number, j: number, c: number, s: number): void {
  for (let k = 0; k < n; ++k) {
    const [x, y] = [m[i * n + k], m[j * n + k]];
    m[i * n + k] = c * x - s * y;
    m[j * n + k] = s * x + c * y;
  }
}

/** One Jacobi rotation in the plane of i and j, which makes the entry there zero. */
function rotatePlane(a: Numbers, v: Numbers, n: number, i: number, j: number): void {
  const off = a[i * n + j];
  if (off === 0) return;
  const theta = (a[j * n + j] - a[i * n + i]) / (2 * off);
  const t = (theta >= 0 ? 1 : -1) / (Math.abs(theta) + Math.sqrt(theta * theta + 1));
  const c = 1 / Math.sqrt(t * t + 1);
  const s = t * c;
  turnColumns(a, n, i, j, c, s);
  turnRows(a, n, i, j, c, s);
  turnColumns(v, n, i, j, c, s);
}

/** Makes a symmetric n x n matrix diagonal by cyclic Jacobi rotations, in place; the columns of v, which begins as the identity, become its eigenvectors. */
export function diagonalise(a: Numbers, v: Numbers, n: number): void {
  for (let sweep = 0; sweep < 40; ++sweep) {
    let off = 0;
    let all = 0;
    for (let i = 0; i < n; ++i) {
      for (let j = 0; j < n; ++j) {
        const square = a[i * n + j] ** 2;
        all += square;
        if (i !== j) off += square;
      }
    }
    if (off <= 1e-30 * all) break;
    for (let i = 0; i < n; ++i) for (let j = i + 1; j < n; ++j) rotatePlane(a, v, n, i, j);
  }
}

/** Eigenvalues and eigenvectors of a symmetric n x n matrix, row by row. */
export function eigenOf(matrix: Numbers, n: number): Eigen {
  const a = Array.from(matrix);
  const v = Array.from({ length: n * n }, (_, k) => (k % (n + 1) === 0 ? 1 : 0));
  diagonalise(a, v, n);
  const order = Array.from({ length: n }, (_, i) => i).sort((i, j) => a[j * n + j] - a[i * n + i]);
  return { values: order.map((i) => a[i * n + i]), vectors: order.map((i) => Array.from({ length: n }, (_, k) => v[k * n + i])) };
}
