// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Whether two series that were measured in the same frames differ by more than chance. Errors of neighbouring frames are alike,
// so that a thousand frames may say no more than ten independent ones.

/** The natural logarithm of the gamma function (Lanczos). */
function logGamma(x: number): number {
  const c = [76.18009172947146, -86.50532032941677, 24.01409824083091, -1.231739572450155, 0.1208650973866179e-2, -0.5395239384953e-5];
  const t = x + 5.5 - (x + 0.5) * Math.log(x + 5.5);
  const sum = c.reduce((total, value, i) => total + value / (x + 1 + i), 1.000000000190015);
  return Math.log((2.5066282746310005 * sum) / x) - t;
}

/** The continued fraction of the incomplete beta function. */
function betaFraction(a: number, b: number, x: number): number {
  const tiny = 1e-300;
  const away = (value: number) => (Math.abs(value) < tiny ? tiny : value);
  let c = 1;
  let d = 1 / away(1 - ((a + b) * x) / (a + 1));
  let h = d;
  for (let m = 1; m <= 300; ++m) {
    const even = (m * (b - m) * x) / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1 / away(1 + even * d);
    c = away(1 + even / c);
    h *= d * c;
    const odd = (-(a + m) * (a + b + m) * x) / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1 / away(1 + odd * d);
    c = away(1 + odd / c);
    h *= d * c;
    if (Math.abs(d * c - 1) < 1e-12) break;
  }
  return h;
}

/** The regularised incomplete beta function I_x(a, b). */
export function incompleteBeta(a: number, b: number, x: number): number {
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  const front = Math.exp(logGamma(a + b) - logGamma(a) - logGamma(b) + a * Math.log(x) + b * Math.log(1 - x));
  return x < (a + 1) / (a + b + 2) ? (front * betaFraction(a, b, x)) / a : 1 - (front * betaFraction(b, a, 1 - x)) / b;
}

/** The probability that Student's t is farther from zero than a value, on either side. */
export function studentP(t: number, dof: number): number {
  return incompleteBeta(dof / 2, 0.5, dof / (dof + t * t));
}

/** What Student's t exceeds in absolute value with a probability. */
export function studentQuantile(p: number, dof: number): number {
  let [low, high] = [0, 1];
  while (studentP(high, dof) > p && high < 1e6) high *= 2;
  for (let i = 0; i < 60; ++i) {
    const middle = (low + high) / 2;
    if (studentP(middle, dof) > p) low = middle;
    else high = middle;
  }
  return high;
}

/** The number of independent values that carry as much about the mean: n / (1 + 2 sum r_k), r_k up to where pairs of them fade. */
export function effectiveSize(values: ArrayLike<number>): number {
  const n = values.length;
  if (n < 3) return Math.min(n, 1);
  let mean = 0;
  for (let i = 0; i < n; ++i) mean += values[i] / n;
  const covariance = (lag: number) => {
    let sum = 0;
    for (let i = 0; i + lag < n; ++i) sum += (values[i] - mean) * (values[i + lag] - mean);
    return sum / n;
  };
  const variance = covariance(0);
  if (variance <= 0) return n;
  let sum = 0;
  // Sums of two neighbouring lags are positive and fall (Geyer's sequence); the rest is noise.
  let last = Infinity;
  for (let lag = 1; lag + 1 < n; lag += 2) {
    const pair = (covariance(lag) + covariance(lag + 1)) / variance;
    if (pair <= 0) break;
    last = Math.min(last, pair);
    sum += last;
  }
  return Math.max(1, Math.min(n, n / (1 + 2 * sum)));
}

export interface Paired {
  frames: number;
  /** Independent frames that carry as much. */
  effective: number;
  /** Mean of a minus b. */
  difference: number;
  standardError: number;
  /** Undefined where too few frames are independent to say. */
  p: number | undefined;
}

const LEAST_EFFECTIVE = 4;
/** More differences are put together into means of blocks, which say the same of the mean of all. */
const MOST_BLOCKS = 4000;

function blockMeans(values: number[]): number[] {
  const size = Math.ceil(values.length / MOST_BLOCKS);
  if (size <= 1) return values;
  return Array.from({ length: Math.floor(values.length / size) }, (_, k) =>
    values.slice(k * size, (k + 1) * size).reduce((sum, value) => sum + value, 0) / size);
}

/** The mean difference a - b over the frames in which both are there, and how likely chance alone makes it as large. */
export function paired(a: ArrayLike<number | null>, b: ArrayLike<number | null>): Paired {
  const differences: number[] = [];
  for (let i = 0; i < Math.min(a.length, b.length); ++i) {
    const [left, right] = [a[i], b[i]];
    if (left !== null && right !== null) differences.push(left - right);
  }
  const n = differences.length;
  const difference = n > 0 ? differences.reduce((sum, value) => sum + value, 0) / n : NaN;
  const blocks = blockMeans(differences);
  const effective = effectiveSize(blocks);
  const variance = blocks.reduce((sum, value) => sum + (value - difference) ** 2, 0) / Math.max(1, blocks.length - 1);
  const standardError = Math.sqrt(variance / Math.max(1, effective));
  if (n > 0 && variance === 0) return { frames: n, effective, difference, standardError: 0, p: difference === 0 ? 1 : 0 };
  if (effective < LEAST_EFFECTIVE) return { frames: n, effective, difference, standardError, p: undefined };
  return { frames: n, effective, difference, standardError, p: studentP(difference / standardError, effective - 1) };
}

/** Probabilities raised for the number of comparisons made at once (Holm); undefined ones stay so and do not count. */
export function holm(ps: readonly (number | undefined)[]): (number | undefined)[] {
  const order = ps.map((p, i) => [p, i] as const).filter((one): one is readonly [number, number] => one[0] !== undefined);
  order.sort((a, b) => a[0] - b[0]);
  const raised: (number | undefined)[] = ps.map(() => undefined);
  let last = 0;
  order.forEach(([p, i], rank) => (raised[i] = last = Math.max(last, Math.min(1, (order.length - rank) * p))));
  return raised;
}
