// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Which norm a consistent error does not exceed.
import { chiSquareQuantile, shareWithin } from "./chi_square.ts";

/** The share of 3 sigma along one axis: norms and axes are then bounded alike. */
export const BOUND_SHARE = shareWithin(3);
const STEPS = 128;
const MOST_DOF = 3;
let table: Float64Array | undefined;

/** Quantile of chi-square with one to three degrees of freedom, from a table: plots ask for it frame by frame. */
function quantile(dof: number): number {
  table ??= Float64Array.from({ length: STEPS + 1 }, (_, i) => chiSquareQuantile(BOUND_SHARE, 1 + ((MOST_DOF - 1) * i) / STEPS));
  const at = (STEPS * (Math.max(1, Math.min(MOST_DOF, dof)) - 1)) / (MOST_DOF - 1);
  const low = Math.min(STEPS - 1, Math.floor(at));
  return table[low] + (at - low) * (table[low + 1] - table[low]);
}

/**
 * The norm that a zero-mean Gaussian of three dimensions with a covariance exceeds in 0.27 % of the cases. The squared
 * norm is a weighted sum of chi-square variables; it is replaced by one chi-square variable with the same mean, variance
 * and skewness (Liu, Tang and Zhang 2009), which is exact for a sphere and for a line. `p`: nine numbers, row by row.
 */
export function normBound(p: ArrayLike<number>): number {
  const first = p[0] + p[4] + p[8];
  let [second, third] = [0, 0];
  for (let i = 0; i < 3; ++i) {
    for (let j = 0; j < 3; ++j) {
      const square = p[3 * i] * p[j] + p[3 * i + 1] * p[3 + j] + p[3 * i + 2] * p[6 + j];
      if (i === j) second += square;
      third += square * p[3 * j + i];
    }
  }
  if (!(second > 0) || !(third > 0)) return 0;
  const dof = second ** 3 / third ** 2;
  const standard = (quantile(dof) - dof) / Math.sqrt(2 * dof);
  return Math.sqrt(Math.max(0, first + Math.sqrt(2 * second) * standard));
}
