// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// How often errors lie within their standard deviations, and what follows.
import { shareWithin } from "../math/chi_square.ts";
import { effectiveFrames, meanSquare, type MeanSquare, type Verdict } from "../math/statistics.ts";
import { sizeText } from "../trace/verdict.ts";
import type { Values } from "./chart.ts";

export const EXPECTED = [shareWithin(1), shareWithin(2), shareWithin(3)] as const;

export interface Coverage {
  frames: number;
  /** Independent frames that say as much. */
  effective: number;
  /** Shares of the frames within 1, 2 and 3 sigma. */
  shares: [number, number, number];
  /** Mean squared error over the variance, 1 when consistent, over the frames that are not gross. */
  square: MeanSquare;
  /** Frames beyond 6 sigma, as on a wrong mode: a few of them say nothing of the others. */
  gross: number;
}

const GROSS_SIGMAS = 6;
/** Six axes are judged, so each by an interval of 99 %, as in `posemix consistency`. */
const AXIS_TAIL = 0.005;
/** Where more than this share is gross, they are no exception. */
const MOST_GROSS = 0.05;

/** Errors over their standard deviations in the frames that have both. */
export function normalized(errors: Values, sigma: Values): Float64Array {
  const found = new Float64Array(errors.length);
  let count = 0;
  errors.forEach((error, i) => {
    const sd = sigma[i];
    if (error !== null && sd !== null && sd > 0) found[count++] = error / sd;
  });
  return found.slice(0, count);
}

export function coverageOf(errors: Values, sigma: Values): Coverage | undefined {
  const ratios = normalized(errors, sigma);
  if (ratios.length === 0) return undefined;
  const share = (limit: number) => ratios.reduce((count, ratio) => count + (Math.abs(ratio) <= limit ? 1 : 0), 0) / ratios.length;
  const effective = effectiveFrames([ratios]);
  const rest = ratios.filter((ratio) => Math.abs(ratio) <= GROSS_SIGMAS);
  const isException = ratios.length - rest.length <= MOST_GROSS * ratios.length;
  const judged = (isException ? rest : ratios).map((ratio) => ratio * ratio);
  return { frames: ratios.length, effective, shares: [share(1), share(2), share(3)], square: meanSquare(judged, 1, effective, AXIS_TAIL), gross: isException ? ratios.length - rest.length : 0 };
}

/** The share of the frames in which a value is at most its bound. */
export function shareBelow(values: Values, bound: Values): number | undefined {
  let [count, within] = [0, 0];
  values.forEach((value, i) => {
    const limit = bound[i];
    if (value === null || limit === null) return;
    ++count;
    if (value <= limit) ++within;
  });
  return count > 0 ? within / count : undefined;
}

/** A share in percent: whole numbers, but near 0 and 1, where the tenth matters. */
export function percent(share: number): string {
  if (share === 0 || share === 1) return `${100 * share} %`;
  if (share > 0.9995) return ">99.9 %";
  if (share < 0.0005) return "<0.1 %";
  return share > 0.985 || share < 0.015 ? `${(100 * share).toFixed(1)} %` : `${(100 * share).toFixed(0)} %`;
}

export function verdictText({ mean }: MeanSquare, verdict: Verdict): string {
  const factor = Math.sqrt(mean);
  if (verdict === "overconfident") return `overconfident, sigma is ${sizeText(factor)}`;
  return verdict === "cautious" ? `cautious, sigma is ${sizeText(factor)}` : "consistent";
}

/** "84 % within 3 sigma (99.7 % expected): overconfident, ..." */
export function coverageText(coverage: Coverage): string {
  const { shares, square } = coverage;
  return `${percent(shares[2])} within 3 sigma (${percent(EXPECTED[2])} expected): ${verdictText(square, square.verdict)}${grossText(coverage)}`;
}

/** ", but for 4 frames beyond 6 sigma", or "" where there are none. */
export function grossText({ gross, square }: Coverage): string {
  if (gross === 0) return "";
  return `, ${square.verdict === "overconfident" ? "and" : "but for"} ${gross} ${gross === 1 ? "frame" : "frames"} beyond 6 sigma`;
}

/** Values where they are outside the bounds, else null: what is marked in a plot. */
export function outside(errors: Values, limit: Values): Values {
  return errors.map((error, i) => {
    const bound = limit[i];
    return error !== null && bound !== null && Math.abs(error) > bound ? error : null;
  });
}
