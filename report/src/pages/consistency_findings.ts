// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What the covariances of one pose are worth, as numbers and in words.
import { DEGREES } from "../math/rotation.ts";
import { meanSquare, type MeanSquare } from "../math/statistics.ts";
import type { Values } from "../plots/chart.ts";
import { type Coverage, coverageOf, EXPECTED, grossText, percent } from "../plots/coverage.ts";
import { type Direction, worstDirection } from "../plots/direction.ts";
import { errorComponents, spreadOf, valuesOf } from "../plots/series.ts";
import { CAMERA, type Entity } from "../state/run_state.ts";
import { deviationOf, effectiveOf } from "../trace/deviation.ts";
import { rightAt } from "../trace/right_mode.ts";
import { estimateOf, neesOf, nisOf, type Of, POSE_DOF, type Square, squaresOf } from "../trace/squares.ts";
import type { Estimate, Trace } from "../trace/trace.ts";
import { BAD_OUTSIDE, sentenceOf, sizeText, type Verdict, verdictOfInnovations } from "../trace/verdict.ts";

/** The mean NEES over the frames on the right mode, where there are others too. */
export interface RightMode {
  frames: number;
  ofFrames: number;
  square: MeanSquare;
}

export interface AxisCoverage {
  name: string;
  coverage: Coverage;
}

export interface Findings {
  /** By frame. */
  nees: Values | undefined;
  nis: Values | undefined;
  rightMode: RightMode | undefined;
  /** Rotation about x, y, z, position along x, y, z; empty without truth. */
  axes: AxisCoverage[];
  direction: Direction | undefined;
}

const HALVES = [["rotation", "rotation about"], ["position", "position"]] as const;
const WORDS = ["x", "y", "z"];
/** What an axis is, in the frame of a camera. */
const SEEN = ["right", "down", "depth"];

function rightModeOf(trace: Trace, estimate: Estimate, nees: Square | undefined): RightMode | undefined {
  const deviation = deviationOf(estimate, trace.frames);
  if (!nees || !deviation) return undefined;
  const right = rightAt(estimate);
  const known = (frame: number) => nees(frame) !== undefined && !Number.isNaN(deviation.largest[frame]);
  const all = Array.from({ length: trace.frames }, (_, frame) => frame).filter(known);
  const frames = all.filter((frame) => right(frame) === true);
  if (frames.length === 0 || frames.length === all.length) return undefined;
  const effective = Math.min(frames.length, effectiveOf(deviation, (frame) => known(frame) && right(frame) === true));
  return { frames: frames.length, ofFrames: all.length, square: meanSquare(frames.map((frame) => nees(frame)!), POSE_DOF, effective) };
}

export function findingsOf(trace: Trace, entity: Entity, of: Of): Findings {
  const estimate = estimateOf(trace, entity, of);
  const [nees, nisAt] = [neesOf(trace, entity, of), nisOf(trace, entity)];
  const nis = nisAt && squaresOf(trace, nisAt)!.some((value) => !Number.isNaN(value)) ? valuesOf(trace.frames, nisAt) : undefined;
  if (!estimate?.truth) return { nees: undefined, rightMode: undefined, nis, axes: [], direction: undefined };
  const errors = errorComponents(estimate.pose, estimate.truth, trace.frames);
  const sigma = spreadOf(estimate, trace.frames);
  const inCamera = entity !== CAMERA && of === "relative";
  const axes = HALVES.flatMap(([half, text]) => WORDS.flatMap((axis, i): AxisCoverage[] => {
    const coverage = coverageOf(errors[half][i], sigma[half][i]);
    const seen = inCamera && half === "position" ? `, ${SEEN[i]}` : "";
    return coverage ? [{ name: `${text} ${axis}${seen}`, coverage }] : [];
  }));
  return {
    nees: nees && valuesOf(trace.frames, nees), rightMode: rightModeOf(trace, estimate, nees), nis, axes, direction: worstDirection(estimate, trace.frames),
  };
}

const rounded = (value: number) => String(Number(value.toPrecision(3)));

/** By axis; what the verdict says of the whole pose is not denied. */
function axesText(axes: AxisCoverage[], { level, word }: Verdict): string[] {
  const of = (verdict: string) => axes.filter(({ coverage }) => coverage.square.verdict === verdict).sort((a, b) => b.coverage.square.mean - a.coverage.square.mean);
  const size = ({ square }: Coverage) => sizeText(Math.sqrt(square.mean));
  const over = of("overconfident").map(({ name, coverage }) => `${name} (sigma ${size(coverage)}, ${percent(coverage.shares[2])} within 3 sigma${grossText(coverage)})`);
  const careful = of("cautious").filter(({ coverage }) => 1 - coverage.shares[2] <= BAD_OUTSIDE).map(({ name, coverage }) => `${name} (${size(coverage)})`);
  const isFarOut = axes.some(({ coverage }) => 1 - coverage.shares[2] > BAD_OUTSIDE);
  const nothing = level === "good" && !isFarOut && over.length + careful.length === 0;
  const lead = level === "good" ? `${word[0].toUpperCase()}${word.slice(1)} as a whole, but errors are larger than sigma along` : "Overconfident along";
  return [
    ...(nothing ? ["By axis, no direction is overconfident or cautious beyond what so many frames can tell."] : []),
    ...(over.length > 0 ? [`${lead}: ${over.join("; ")}. ${percent(EXPECTED[2])} are expected within 3 sigma.`] : []),
    ...(careful.length > 0 ? [`Cautious along: ${careful.join("; ")}.`] : []),
  ];
}

function directionText({ along, factor }: Direction, frame: string): string {
  const main = along.findIndex((value) => Math.abs(value) > Math.cos(15 / DEGREES));
  const words = main >= 0 ? `, nearly ${WORDS[main]}` : "";
  return `Of all directions the position's errors are largest against their covariance along (${along.map((value) => value.toFixed(2)).join(", ")}) of the ${frame}${words}: ${factor.toFixed(1)} times sigma.`;
}

/** The findings in sentences, the verdict first. */
export function sentences({ rightMode, nis, axes, direction }: Findings, verdict: Verdict, frame: string): string[] {
  const found = [sentenceOf(verdict)];
  if (rightMode) {
    const { mean, interval: [low, high], verdict: word } = rightMode.square;
    found.push(`A wrong mode is no matter of sigmas: over the ${rightMode.frames} of ${rightMode.ofFrames} frames on the right mode ANEES is ${rounded(mean)}, ${rounded(low)} to ${rounded(high)}: ${word}.`);
  }
  if (axes.length > 0) found.push(...axesText(axes, verdict));
  if (direction) found.push(directionText(direction, frame));
  const innovations = nis && axes.length > 0 ? verdictOfInnovations(Float32Array.from(nis, (value) => value ?? NaN)) : undefined;
  if (innovations) found.push(sentenceOf(innovations));
  return found;
}
