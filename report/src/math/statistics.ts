// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Statistics of series that are correlated from frame to frame.
import { chiSquareQuantile } from "./chi_square.ts";

type Values = ArrayLike<number>;
export type Interval = [number, number];

export interface Summary {
  count: number;
  rmse: number;
  mean: number;
  median: number;
  std: number;
  min: number;
  max: number;
}

/** The middle value, of an even number the mean of the two in the middle; NaN of none. */
export function median(values: Values): number {
  const sorted = Float64Array.from(values).sort();
  const half = sorted.length >> 1;
  return sorted.length % 2 === 1 ? sorted[half] : 0.5 * (sorted[half - 1] + sorted[half]);
}

/** The statistics of evo; std is that of the population. */
export function summaryOf(values: Values): Summary {
  const n = values.length;
  const sorted = Float64Array.from(values).sort();
  let [sum, squares] = [0, 0];
  for (let i = 0; i < n; ++i) {
    sum += sorted[i];
    squares += sorted[i] * sorted[i];
  }
  const mean = sum / n;
  let spread = 0;
  for (let i = 0; i < n; ++i) spread += (sorted[i] - mean) ** 2;
  return {
    count: n, rmse: Math.sqrt(squares / n), mean, median: median(sorted),
    std: Math.sqrt(spread / n), min: n > 0 ? sorted[0] : NaN, max: n > 0 ? sorted[n - 1] : NaN,
  };
}

/** The value below which a share of sorted values lies, by linear interpolation. */
export function quantileOfSorted(sorted: Values, share: number): number {
  const at = Math.max(0, Math.min(1, share)) * (sorted.length - 1);
  const low = Math.floor(at);
  const high = Math.min(sorted.length - 1, low + 1);
  return sorted[low] + (at - low) * (sorted[high] - sorted[low]);
}

/** Lags grow by a sixteenth, so that a long series costs n log n. */
const nextLag = (lag: number) => lag + Math.max(1, lag >> 4);

/** 2 sum of correlations over all lags until they are not above `least`; between the lags they are taken as linear. */
function twiceSum(n: number, least: number, at: (lag: number) => number): number {
  let [sum, before, last] = [0, 0, 0];
  for (let lag = 1; lag < n; lag = nextLag(lag)) {
    const here = at(lag);
    if (!(here > least)) break;
    const steps = lag - last;
    sum += last === 0 ? here : 0.5 * (steps * (before + here) + here - before);
    [before, last] = [here, lag];
  }
  return 2 * sum;
}

const LEAST_SQUARED = 0.02;

/**
 * The number of independent frames that say as much on consistency as these normalised errors, a row per component:
 * n / (1 + 2 sum r_k) with the squared autocorrelations about zero, so that an error that never changes counts as one
 * look (the rule of `posemix consistency`).
 */
export function effectiveFrames(components: readonly Values[]): number {
  const n = components[0]?.length ?? 0;
  let all = 0;
  for (const values of components) {
    let power = 0;
    for (let i = 0; i < n; ++i) power += values[i] * values[i];
    all += power * power;
  }
  if (n <= 2 || !(all > 0)) return Math.min(n, 1);
  const at = (lag: number) => {
    const m = n - lag;
    if (m < 2) return 0;
    let products = 0;
    for (const values of components) {
      let sum = 0;
      for (let i = 0; i < m; ++i) sum += values[i] * values[i + lag];
      products += sum * sum;
    }
    const squared = (products / all) * (n / m) ** 2;
    return ((m / n) * (m * squared - 1)) / (m - 1);
  };
  return Math.max(1, Math.min(n, n / (1 + twiceSum(n, LEAST_SQUARED, at))));
}

/** The same for a series of which only the values are known: n / (1 + 2 sum r_k) about its mean. */
export function effectiveSamples(values: Values): number {
  const n = values.length;
  if (n <= 2) return Math.min(n, 1);
  let mean = 0;
  for (let i = 0; i < n; ++i) mean += values[i] / n;
  let power = 0;
  for (let i = 0; i < n; ++i) power += (values[i] - mean) ** 2;
  // Rounding errors of a constant are no variation.
  if (!(power > 1e-20 * n * mean * mean)) return 1;
  const at = (lag: number) => {
    let sum = 0;
    for (let i = 0; i + lag < n; ++i) sum += (values[i] - mean) * (values[i + lag] - mean);
    return sum / power;
  };
  return Math.max(1, Math.min(n, n / (1 + twiceSum(n, 2 / Math.sqrt(n), at))));
}

export type Verdict = "consistent" | "overconfident" | "cautious";

export interface MeanSquare {
  /** Mean of the squares per degree of freedom; 1 when consistent. */
  mean: number;
  interval: Interval;
  verdict: Verdict;
}

/**
 * The mean of squared normalised errors with `dof` degrees of freedom each, and its 95 % interval: chi-square with
 * `frames` * dof degrees of freedom, fewer where the squares scatter more than chi-square does. The verdict is that of an
 * interval with `tail` on either side: less than for the whole where several parts are judged, of which one may stray.
 */
export function meanSquare(squares: Values, dof: number, frames: number, tail = 0.025): MeanSquare {
  const n = squares.length;
  let mean = 0;
  for (let i = 0; i < n; ++i) mean += squares[i] / dof / n;
  let variance = 0;
  for (let i = 0; i < n; ++i) variance += (squares[i] / dof - mean) ** 2 / n;
  if (!(mean > 0)) return { mean, interval: [0, 0], verdict: "cautious" };
  const all = (frames * dof) / Math.max(1, (0.5 * dof * variance) / (mean * mean));
  const intervalOf = (beyond: number): Interval => [(mean * all) / chiSquareQuantile(1 - beyond, all), (mean * all) / chiSquareQuantile(beyond, all)];
  const [low, high] = intervalOf(tail);
  return { mean, interval: intervalOf(0.025), verdict: low > 1 ? "overconfident" : high < 1 ? "cautious" : "consistent" };
}

/** Wilson's 95 % interval of a share of `count` independent looks. */
export function shareInterval(share: number, count: number): Interval {
  const z2 = chiSquareQuantile(0.95, 1);
  const centre = (share + z2 / (2 * count)) / (1 + z2 / count);
  const half = (Math.sqrt(z2) / (1 + z2 / count)) * Math.sqrt((share * (1 - share)) / count + z2 / (4 * count * count));
  return [Math.max(0, centre - half), Math.min(1, centre + half)];
}
