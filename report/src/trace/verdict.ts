// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Whether covariances are as large as the errors, in a word and in a sentence: what cards, overview and the tab on consistency say.
import { effectiveSamples, type Interval, meanSquare, type Verdict as Word } from "../math/statistics.ts";
import { isObject, type Json, type JsonObject } from "../payload.ts";
import { fixed, percent, plural, short } from "../ui/numbers.ts";
import { AXIS_NAMES, type Deviation, effectiveOf, worstAxis } from "./deviation.ts";
import { POSE_DOF, withinBand } from "./squares.ts";

/** good: as it should be; fair: look at it; bad: do not rely on it; none: cannot be told. */
export type Level = "good" | "fair" | "bad" | "none";

export interface Verdict {
  level: Level;
  word: string;
  /** What it rests on, in short, and at length as the tab on consistency says it. */
  reason: string;
  sentence: string;
}

/** The verdict of the program, or one that follows the same rule. */
export interface Finding {
  verdict: Word;
  /** What is most at fault; may be empty. */
  reason: string;
  anees: number;
  /** 95 % confidence interval of the ANEES. */
  interval: Interval;
  /** Independent frames that say as much. */
  effective: number;
}

/** Standard deviations that are too small by more are bad. */
const BAD_FACTOR = 1.5;
/** 0.3 % of the errors of an axis are beyond 3 sigma by chance; twice as many are worth a word, as in the program. */
const NAMED_OUTSIDE = 0.0054;
const FAIR_OUTSIDE = 0.01;
export const BAD_OUTSIDE = 0.05;
/** Innovations of which as many are within their 95 % band are as expected, however sure it is that they are a little too large. */
const LEAST_WITHIN = 0.93;

function unknown(reason: string): Verdict {
  return { level: "none", word: "not known", reason, sentence: reason };
}
export const NO_TRUTH = unknown("There is no ground truth for this pose.");
export const NEVER = unknown("It was never estimated.");
export const NO_ERROR = unknown("No frame has an error and a covariance to compare it with.");

/** "1.6 times too small"; where that rounds to once, in percent. */
export function sizeText(factor: number): string {
  const [ratio, word] = factor > 1 ? [factor, "small"] : [1 / Math.max(factor, 1e-3), "large"];
  return ratio < 1.2 ? `${Math.max(1, Math.round(100 * (ratio - 1)))} % too ${word}` : `${fixed(ratio, 1)} times too ${word}`;
}

const rounded = (value: number) => String(Number(value.toPrecision(3)));

function worthText(frames: number, effective: number): string {
  if (frames === 1) return "That is one frame alone.";
  if (effective > frames - 0.5) return `Its ${frames} frames are independent of one another.`;
  const worth = rounded(effective);
  return `Frames are correlated: ${frames} of them say as much as ${worth} independent ${worth === "1" ? "one" : "ones"}.`;
}

/** "ANEES 3.56 per degree of freedom (1 expected), 95 % interval 2 to 5: sigmas are about 1.9 times too small. ..." */
function squareText(name: string, spread: string, { anees, interval: [low, high], effective }: Finding, frames: number): string {
  const factor = Math.sqrt(anees);
  const size = low > 1 || high < 1 ? `: ${spread} are about ${sizeText(factor)}` : "";
  return `${name} ${rounded(anees)} per degree of freedom (1 expected), 95 % interval ${rounded(low)} to ${rounded(high)}${size}. ${worthText(frames, effective)}`;
}

const object = (value: Json | undefined): JsonObject => (isObject(value) ? value : {});
const isWord = (value: Json | undefined): value is Word => value === "consistent" || value === "overconfident" || value === "cautious";

/** What metrics.json says of the camera in the world (no id) or of an object as seen from it; undefined where it says nothing. */
export function findingIn(metrics: Json | undefined, id: string | undefined): Finding | undefined {
  const consistency = object(object(metrics)["consistency"]);
  const stated = object(id === undefined ? consistency["camera_verdict"] : object(consistency["relative_verdicts"])[id]);
  const { verdict, reason, anees, interval, effective_frames: effective } = stated;
  const [low, high] = Array.isArray(interval) ? interval : [];
  if (!isWord(verdict) || typeof anees !== "number" || typeof low !== "number" || typeof high !== "number" || typeof effective !== "number") return undefined;
  return { verdict, reason: typeof reason === "string" ? reason : "", anees, interval: [low, high], effective };
}

const outsideText = (name: string, share: number) => `${percent(share, share < 0.1 ? 1 : 0)} of ${name} outside 3 sigma`;

/** From NEES and errors: by the interval of the mean, but errors far out in many frames are too many however alike the frames are. */
function findingOf(nees: Float32Array, deviation: Deviation): Finding | undefined {
  const values = nees.filter((value, frame) => !Number.isNaN(value) && !Number.isNaN(deviation.largest[frame]));
  if (values.length === 0) return undefined;
  const effective = Math.min(values.length, effectiveOf(deviation));
  const { mean, interval, verdict } = meanSquare(values, POSE_DOF, effective);
  const { name, share } = worstAxis(deviation);
  const isOver = verdict === "overconfident" || share > BAD_OUTSIDE;
  const reason = isOver && share > NAMED_OUTSIDE ? outsideText(name, share) : "";
  return { verdict: isOver ? "overconfident" : verdict, reason, anees: mean, interval, effective };
}

function levelOf({ verdict, anees }: Finding, share: number): Pick<Verdict, "level" | "word"> {
  if (verdict === "consistent") return { level: "good", word: verdict };
  if (verdict === "cautious") return { level: "fair", word: verdict };
  const isBad = Math.sqrt(anees) > BAD_FACTOR || share > BAD_OUTSIDE;
  return isBad ? { level: "bad", word: verdict } : { level: "fair", word: "slightly overconfident" };
}

/** From the shares of errors beyond 3 sigma, by axis: where there is no NEES. */
export function verdictOfCoverage(deviation: Pick<Deviation, "frames" | "outside">): Verdict {
  const { frames, outside } = deviation;
  const { name, share } = worstAxis(deviation);
  const reason = `${share === 0 ? "No error" : `${percent(share, 1)} of the errors of ${name}`} beyond 3 sigma, expected 0.3 %.`;
  const sentence = `${reason} ${plural(frames, "frame")}; ${AXIS_NAMES.map((axis, i) => `${axis} ${percent(outside[i] / frames, 1)}`).join(", ")}.`;
  if (share > BAD_OUTSIDE) return { level: "bad", word: "overconfident", reason, sentence };
  if (share > FAIR_OUTSIDE) return { level: "fair", word: "slightly overconfident", reason, sentence };
  return { level: "good", word: "not overconfident", reason, sentence };
}

/** What the program found, where it said so; else from NEES, else from the shares of errors beyond 3 sigma. */
export function verdictOfErrors(stated: Finding | undefined, nees: Float32Array | undefined, deviation: Deviation): Verdict {
  const finding = stated ?? (nees && findingOf(nees, deviation));
  if (!finding) return verdictOfCoverage(deviation);
  const { anees, interval: [low, high], effective, verdict } = finding;
  const { name, share } = worstAxis(deviation);
  // A reader who sees many errors far out beside "consistent" must be told why.
  const reason = verdict === "consistent" && share > BAD_OUTSIDE ? `${outsideText(name, share)}, but so few independent frames are no proof` : finding.reason;
  const why = reason === "" ? "" : `${reason[0].toUpperCase()}${reason.slice(1)}. `;
  return {
    ...levelOf(finding, share),
    reason: `${why}ANEES ${rounded(anees)} (1 expected), 95 % interval ${rounded(low)} to ${rounded(high)} from ${plural(Number(rounded(effective)), "independent frame")}.`,
    sentence: why + squareText("ANEES", "sigmas", finding, deviation.frames),
  };
}

/** From squared innovations, which tell nothing of errors. */
export function verdictOfInnovations(nis: Float32Array): Verdict | undefined {
  const values = nis.filter((value) => !Number.isNaN(value));
  if (values.length === 0) return undefined;
  const effective = effectiveSamples(values);
  const { mean, interval, verdict } = meanSquare(values, POSE_DOF, effective);
  const share = withinBand(values).within / values.length;
  const isExpected = verdict === "consistent" || share >= LEAST_WITHIN;
  const isBad = verdict === "overconfident" && Math.sqrt(mean) > BAD_FACTOR;
  const within = `${percent(share)} of the innovations are within their 95 % band.`;
  return {
    level: isExpected ? "good" : isBad ? "bad" : "fair",
    word: isExpected ? "innovations as expected" : isBad ? "innovations too large" : verdict === "cautious" ? "innovations small" : "innovations large",
    reason: `Mean NIS ${short(mean)} (1 expected); ${within}`,
    sentence: `${squareText("Mean NIS", "the sigmas of the innovations", { verdict, reason: "", anees: mean, interval, effective }, values.length)} ${within}`,
  };
}

/** As the first sentence on a pose: "Slightly overconfident: ..." */
export const sentenceOf = ({ word, sentence }: Verdict): string => `${word[0].toUpperCase()}${word.slice(1)}: ${sentence}`;
