// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Whether covariances are as large as the errors, in a word.
import { effectiveSamples, meanSquare } from "../math/statistics.ts";
import { fixed, percent, plural, short } from "../ui/numbers.ts";
import { AXIS_NAMES, type Deviation } from "./deviation.ts";

/** good: as it should be; fair: look at it; bad: do not rely on it; none: cannot be told. */
export type Level = "good" | "fair" | "bad" | "none";

export interface Verdict {
  level: Level;
  word: string;
  /** What it rests on, in short and at length. */
  reason: string;
  detail: string;
}

const DOF = 6;
/** Standard deviations that are too small by more are bad. */
const BAD_FACTOR = 1.5;
/** 0.3 % of the errors of an axis are beyond 3 sigma by chance. */
const FAIR_OUTSIDE = 0.01;
const BAD_OUTSIDE = 0.05;

export const UNKNOWN: Verdict = { level: "none", word: "not known", reason: "There is no ground truth for this pose.", detail: "" };

/** Of NEES, and of NIS, which tells nothing of errors. */
const WORDS = {
  NEES: { good: "consistent", cautious: "cautious", fair: "slightly overconfident", bad: "overconfident", spread: "sigmas" },
  NIS: { good: "innovations as expected", cautious: "innovations small", fair: "innovations large", bad: "innovations too large", spread: "the sigmas of the innovations" },
} as const;

/** From squared Mahalanobis distances of six degrees of freedom. */
export function verdictOfSquares(squares: Float32Array, name: keyof typeof WORDS): Verdict | undefined {
  const words = WORDS[name];
  const values = squares.filter((value) => !Number.isNaN(value));
  if (values.length === 0) return undefined;
  const effective = effectiveSamples(values);
  const { mean, interval, verdict } = meanSquare(values, DOF, effective);
  const factor = Math.sqrt(mean);
  const detail = `95 % interval ${short(interval[0])} to ${short(interval[1])} from ${plural(values.length, "frame")}, worth ${fixed(effective, effective < 9.5 ? 1 : 0)} independent ones.`;
  const reason = `Mean ${name} per degree of freedom ${short(mean)}, expected 1`;
  if (verdict === "consistent") return { level: "good", word: words.good, reason: `${reason}.`, detail };
  if (verdict === "cautious") return { level: "fair", word: words.cautious, reason: `${reason}: ${words.spread} ${short(1 / factor)} times too large.`, detail };
  const level = factor > BAD_FACTOR ? "bad" : "fair";
  return { level, word: words[level], reason: `${reason}: ${words.spread} ${short(factor)} times too small.`, detail };
}

/** From the shares of errors beyond 3 sigma, by axis. */
export function verdictOfCoverage({ frames, outside }: Deviation): Verdict {
  const most = Math.max(...outside);
  const share = most / frames;
  const axis = AXIS_NAMES[outside.indexOf(most)];
  const reason = `${most === 0 ? "No error" : `${percent(share, 1)} of the errors of ${axis}`} beyond 3 sigma, expected 0.3 %.`;
  const detail = `${plural(frames, "frame")}; ${AXIS_NAMES.map((name, i) => `${name} ${percent(outside[i] / frames, 1)}`).join(", ")}.`;
  if (share > BAD_OUTSIDE) return { level: "bad", word: "overconfident", reason, detail };
  if (share > FAIR_OUTSIDE) return { level: "fair", word: "slightly overconfident", reason, detail };
  return { level: "good", word: "not overconfident", reason, detail };
}

/** NEES is the first judge, but where its series is too alike to say much, errors far out in many frames still count. */
export function verdictOfErrors(nees: Float32Array | undefined, deviation: Deviation): Verdict {
  const coverage = verdictOfCoverage(deviation);
  const squares = nees && verdictOfSquares(nees, "NEES");
  if (!squares) return coverage;
  if (squares.level !== "good" || coverage.level === "good") return squares;
  return { level: "fair", word: "overconfident at times", reason: coverage.reason, detail: `${squares.reason} ${squares.detail} ${coverage.detail}` };
}
