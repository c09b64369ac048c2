// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What the covariances of one pose are worth, as numbers and in words.
import { DEGREES } from "../math/rotation.ts";
import { effectiveFrames, effectiveSamples, meanSquare, type MeanSquare } from "../math/statistics.ts";
import type { Values } from "../plots/chart.ts";
import { type Coverage, coverageOf, EXPECTED, grossText, normalized, percent } from "../plots/coverage.ts";
import { type Direction, worstDirection } from "../plots/direction.ts";
import { rightAt } from "../plots/reliability.ts";
import { errorComponents, type PoseSeries, type Spread, spreadOf, valuesOf } from "../plots/series.ts";
import { withinBand } from "../plots/squares_chart.ts";
import { CAMERA, type Entity } from "../state/run_state.ts";
import { estimateOf, neesOf, nisOf, type Of, POSE_DOF, type Square } from "../trace/squares.ts";
import type { Trace } from "../trace/trace.ts";

export interface Squares {
  values: Values;
  frames: number;
  /** Independent frames that say as much. */
  effective: number;
  square: MeanSquare;
}

export interface AxisCoverage {
  name: string;
  coverage: Coverage;
}

export interface Findings {
  nees: Squares | undefined;
  /** The same over the frames on the right mode, where there are others too. */
  rightMode: Squares | undefined;
  nis: Squares | undefined;
  /** Rotation about x, y, z, position along x, y, z; empty without truth. */
  axes: AxisCoverage[];
  direction: Direction | undefined;
}

const HALVES = [["rotation", "rotation about"], ["position", "position"]] as const;
const WORDS = ["x", "y", "z"];
/** What an axis is, in the frame of a camera. */
const SEEN = ["right", "down", "depth"];

function squaresOf(trace: Trace, square: Square | undefined, effective: (values: Float64Array) => number): Squares | undefined {
  if (!square) return undefined;
  const values = valuesOf(trace.frames, square);
  const known = Float64Array.from(values.filter((value) => value !== null));
  if (known.length === 0) return undefined;
  const worth = effective(known);
  return { values, frames: known.length, effective: worth, square: meanSquare(known, POSE_DOF, worth) };
}

/** Errors over sigma by component, in the frames where all are known and `take` holds. */
function ratiosOf(errors: PoseSeries, sigma: Spread, take: (frame: number) => boolean): Float64Array[] {
  const only = (values: Values) => values.map((value, frame) => (take(frame) ? value : null));
  const lists = HALVES.flatMap(([half]) => WORDS.map((_, i) => normalized(only(errors[half][i]), sigma[half][i])));
  return lists.filter((list) => list.length > 0 && list.length === lists[0].length);
}

export function findingsOf(trace: Trace, entity: Entity, of: Of): Findings {
  const estimate = estimateOf(trace, entity, of);
  const nis = squaresOf(trace, nisOf(trace, entity), effectiveSamples);
  if (!estimate?.truth) return { nees: undefined, rightMode: undefined, nis, axes: [], direction: undefined };
  const errors = errorComponents(estimate.pose, estimate.truth, trace.frames);
  const sigma = spreadOf(estimate, trace.frames);
  const inCamera = entity !== CAMERA && of === "relative";
  const axes = HALVES.flatMap(([half, text]) => WORDS.flatMap((axis, i): AxisCoverage[] => {
    const coverage = coverageOf(errors[half][i], sigma[half][i]);
    const seen = inCamera && half === "position" ? `, ${SEEN[i]}` : "";
    return coverage ? [{ name: `${text} ${axis}${seen}`, coverage }] : [];
  }));
  const nees = neesOf(trace, entity, of);
  const over = (take: (frame: number) => boolean) => {
    const ratios = ratiosOf(errors, sigma, take);
    return squaresOf(trace, nees && ((frame) => (take(frame) ? nees(frame) : undefined)),
      (known) => (ratios.length > 0 ? Math.min(known.length, effectiveFrames(ratios)) : effectiveSamples(known)));
  };
  const right = rightAt(estimate);
  const [all, rightMode] = [over(() => true), over((frame) => right(frame) === true)];
  const isMixed = all && rightMode && rightMode.frames < all.frames;
  return { nees: all, rightMode: isMixed ? rightMode : undefined, nis, axes, direction: worstDirection(estimate, trace.frames) };
}

const rounded = (value: number) => String(Number(value.toPrecision(3)));

/** "ANEES 3.56 per degree of freedom (1 expected), ..." */
export function squareText(name: string, { frames, effective, square }: Squares): string {
  const { mean, interval: [low, high], verdict } = square;
  const factor = Math.sqrt(mean);
  const words = verdict === "consistent"
    ? "nothing speaks against the covariances"
    : verdict === "overconfident" ? `overconfident, sigmas are about ${factor.toFixed(1)} times too small` : `cautious, sigmas are about ${(1 / factor).toFixed(1)} times too large`;
  return `${name} ${rounded(mean)} per degree of freedom (1 expected), 95 % interval ${rounded(low)} to ${rounded(high)}: ${words}. Frames are correlated: ${frames} of them say as much as ${rounded(effective)} independent ones.`;
}

function axesText(axes: AxisCoverage[]): string[] {
  const of = (verdict: string) => axes.filter(({ coverage }) => coverage.square.verdict === verdict).sort((a, b) => b.coverage.square.mean - a.coverage.square.mean);
  const over = of("overconfident").map(({ name, coverage }) => `${name} (sigma ${Math.sqrt(coverage.square.mean).toFixed(1)} times too small, ${percent(coverage.shares[2])} within 3 sigma${grossText(coverage)})`);
  const careful = of("cautious").map(({ name, coverage }) => `${name} (${(1 / Math.max(1e-3, Math.sqrt(coverage.square.mean))).toFixed(1)} times too large)`);
  if (over.length + careful.length === 0) return ["By axis, no direction is overconfident or cautious beyond what so many frames can tell."];
  return [...(over.length > 0 ? [`Overconfident along: ${over.join("; ")}. ${percent(EXPECTED[2])} are expected within 3 sigma.`] : []),
    ...(careful.length > 0 ? [`Cautious along: ${careful.join("; ")}.`] : [])];
}

function directionText({ along, factor }: Direction, frame: string): string {
  const main = along.findIndex((value) => Math.abs(value) > Math.cos(15 / DEGREES));
  const words = main >= 0 ? `, nearly ${WORDS[main]}` : "";
  return `Of all directions the position's errors are largest against their covariance along (${along.map((value) => value.toFixed(2)).join(", ")}) of the ${frame}${words}: ${factor.toFixed(1)} times sigma.`;
}

/** The findings in sentences, the most telling first. */
export function sentences({ nees, rightMode, nis, axes, direction }: Findings, frame: string): string[] {
  const found: string[] = [];
  if (nees) found.push(squareText("ANEES", nees));
  if (nees && rightMode) {
    const { mean, interval: [low, high], verdict } = rightMode.square;
    found.push(`A wrong mode is no matter of sigmas: over the ${rightMode.frames} of ${nees.frames} frames on the right mode ANEES is ${rounded(mean)}, ${rounded(low)} to ${rounded(high)}: ${verdict}.`);
  }
  if (axes.length > 0) found.push(...axesText(axes));
  if (direction) found.push(directionText(direction, frame));
  if (nis) {
    const { frames, within } = withinBand(nis.values);
    found.push(`${squareText("Mean NIS", nis)} ${percent(within / frames)} of the innovations are within the 95 % band.`);
  }
  return found;
}
