// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Principal axes of symmetric 3x3 matrices, row by row, without memory of their own per call.
import { diagonalise } from "./eigen.ts";
import type { Numbers } from "./rotation.ts";

const work = new Float64Array(9);

function swap(values: Numbers, vectors: Numbers, i: number, j: number): void {
  if (values[i] >= values[j]) return;
  const value = values[i];
  values[i] = values[j];
  values[j] = value;
  for (let k = 0; k < 3; ++k) {
    const part = vectors[3 * k + i];
    vectors[3 * k + i] = vectors[3 * k + j];
    vectors[3 * k + j] = part;
  }
}

/** Eigenvalues, the largest first, and unit eigenvectors as the columns of `vectors`. */
export function eigen3(p: Numbers, values: Numbers, vectors: Numbers): void {
  for (let i = 0; i < 9; ++i) {
    work[i] = p[i];
    vectors[i] = i % 4 === 0 ? 1 : 0;
  }
  diagonalise(work, vectors, 3);
  for (let i = 0; i < 3; ++i) values[i] = work[4 * i];
  swap(values, vectors, 0, 1);
  swap(values, vectors, 1, 2);
  swap(values, vectors, 0, 1);
}

/** out = A P A^T of 3x3 matrices; out may be p. */
export function turned3(a: Numbers, p: Numbers, out: Numbers): void {
  for (let i = 0; i < 3; ++i) {
    for (let j = 0; j < 3; ++j) {
      let sum = 0;
      for (let k = 0; k < 3; ++k) for (let l = 0; l < 3; ++l) sum += a[3 * i + k] * p[3 * k + l] * a[3 * j + l];
      work[3 * i + j] = sum;
    }
  }
  for (let i = 0; i < 9; ++i) out[i] = work[i];
}

/** Root of u^T P u, u being a column of a matrix. */
export function sdAlong(p: Numbers, columns: Numbers, column: number): number {
  let sum = 0;
  for (let k = 0; k < 3; ++k) for (let l = 0; l < 3; ++l) sum += columns[3 * k + column] * p[3 * k + l] * columns[3 * l + column];
  return Math.sqrt(Math.max(0, sum));
}
