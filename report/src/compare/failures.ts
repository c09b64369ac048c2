// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// When a run failed, at which object, and why: spells on a wrong mode, and objects that it does not estimate.
import { DEGREES, log, multiply } from "../math/rotation.ts";
import { median } from "../math/statistics.ts";
import type { Trace } from "../trace/trace.ts";
import { RIGHT_DEG, RIGHT_MM } from "./metrics.ts";
import type { Comparison, Run } from "./runs.ts";

/** Shorter spells are not failures, and shorter returns do not end one [s]. */
const LEAST_SECONDS = 0.5;
const LEAST_FRAMES = 3;
const USED = new Set(["started", "used", "doubted", "birth"]);

export interface Failure {
  run: Run;
  id: string;
  kind: "wrong mode" | "no estimate" | "other mode";
  /** On the timeline [s]. */
  from: number;
  until: number;
  /** Whether it lasts to the run's last frame, or begins with the first estimate. */
  toTheEnd: boolean;
  fromTheStart: boolean;
  why: string;
}

interface Spell {
  first: number;
  last: number;
}

/** Spells in which a state holds; `undefined` states neither end nor begin one, and short returns do not end one. */
export function spellsOf(states: readonly (boolean | undefined)[], seconds: ArrayLike<number>): Spell[] {
  const spells: Spell[] = [];
  states.forEach((state, i) => {
    if (!state) return;
    const last = spells[spells.length - 1];
    if (last && seconds[i] - seconds[last.last] <= LEAST_SECONDS) last.last = i;
    else if (last && states.slice(last.last + 1, i).every((one) => one === undefined)) last.last = i;
    else spells.push({ first: i, last: i });
  });
  return spells.filter(({ first, last }) => {
    const count = states.slice(first, last + 1).filter(Boolean).length;
    return seconds[last] - seconds[first] >= LEAST_SECONDS && count >= LEAST_FRAMES;
  });
}

/** The axis of the object about which the estimate is turned, if it is one of its axes. */
function axisOf(trace: Trace, index: number, frame: number): string {
  const { relative } = trace.objects[index];
  if (!relative?.truth) return "";
  const [own, truth, turn] = [[0, 0, 0, 1], [0, 0, 0, 1], [0, 0, 0]];
  relative.pose.quaternion(frame, own);
  relative.truth.quaternion(frame, truth);
  // R_est^T R_true, in the axes of the object.
  multiply([-own[0], -own[1], -own[2], own[3]], truth, own);
  log(own, turn);
  const angle = Math.hypot(...turn);
  const most = turn.findIndex((part) => Math.abs(part) > 0.95 * angle);
  return most < 0 || angle * DEGREES < RIGHT_DEG ? "" : ` about its ${"xyz"[most]} axis`;
}

/** "221 mm", "2.4 m". */
function lengthText(mm: number): string {
  if (mm >= 1000) return `${Number((mm / 1000).toPrecision(2))} m`;
  return `${mm >= 10 ? mm.toFixed(0) : Number(mm.toPrecision(2))} mm`;
}

const angleText = (degrees: number) => `${degrees >= 10 ? degrees.toFixed(0) : Number(degrees.toPrecision(2))} deg`;

/** How many detections in these frames were right, and how many were used. */
function detectionsIn(trace: Trace, index: number, frames: number[]): string {
  const { detection, relative, status } = trace.objects[index];
  if (!detection || !relative?.truth) return "";
  const [p, q, t, r] = [[0, 0, 0], [0, 0, 0, 1], [0, 0, 0], [0, 0, 0, 1]];
  let [seen, right, used] = [0, 0, 0];
  for (const frame of frames) {
    if (!detection.has(frame) || !relative.truth.has(frame)) continue;
    detection.position(frame, p);
    relative.truth.position(frame, t);
    detection.quaternion(frame, q);
    relative.truth.quaternion(frame, r);
    const dot = Math.abs(q[0] * r[0] + q[1] * r[1] + q[2] * r[2] + q[3] * r[3]);
    const degrees = 2 * Math.acos(Math.min(1, dot)) * DEGREES;
    ++seen;
    if (degrees <= RIGHT_DEG && 1000 * Math.hypot(p[0] - t[0], p[1] - t[1], p[2] - t[2]) <= RIGHT_MM) ++right;
    if (status && USED.has(trace.statuses[status[frame]] ?? "")) ++used;
  }
  if (seen === 0) return "nothing is detected in that time";
  const share = (count: number) => `${Math.round((100 * count) / seen)} %`;
  return `of ${seen} detections in that time ${share(right)} are right${status ? ` and ${share(used)} are used` : ""}`;
}

function reasonOf(run: Run, index: number, places: number[]): string {
  const { id } = run.trace.objects[index];
  const [error, sigma] = [run.error(id)!, run.sigma(id)];
  const pick = (values: (number | null)[] | undefined) => places.map((i) => values?.[i] ?? null).filter((value): value is number => value !== null);
  const [degrees, mm] = [median(pick(error.angle)), median(pick(error.distance))];
  const isTurned = degrees > RIGHT_DEG;
  const own = pick(isTurned ? sigma?.angle : sigma?.distance);
  const off = isTurned
    ? `turned by ${degrees.toFixed(0)} deg${axisOf(run.trace, index, run.frames[places[Math.floor(places.length / 2)]])}` : `off by ${lengthText(mm)}`;
  const said = own.length > 0 ? `, its own 99.7 % bound is ${(isTurned ? angleText : lengthText)(median(own))}` : "";
  const seen = detectionsIn(run.trace, index, places.map((i) => run.frames[i]).filter((frame) => frame >= 0));
  return `${off}${said}${seen ? `; ${seen}` : ""}`;
}

/** On the right mode, on a wrong one, or not known: who is honestly unsure is on none. */
function isWrongAt(degrees: number | null, mm: number | null, boundDegrees: number | null, boundMm: number | null): boolean | undefined {
  if (degrees === null || mm === null) return undefined;
  const beyond = (error: number, right: number, bound: number | null) => error > right && (bound === null || error > bound);
  if (beyond(degrees, RIGHT_DEG, boundDegrees) || beyond(mm, RIGHT_MM, boundMm)) return true;
  return degrees > RIGHT_DEG || mm > RIGHT_MM ? undefined : false;
}

function wrongModes(run: Run, index: number, timeline: Trace): Failure[] {
  const { id } = run.trace.objects[index];
  const error = run.error(id);
  if (!error) return [];
  const bound = run.sigma(id);
  const states = error.angle.map((degrees, i) => isWrongAt(degrees, error.distance[i], bound?.angle[i] ?? null, bound?.distance[i] ?? null));
  const known = error.angle.flatMap((degrees, i) => (degrees === null ? [] : [i]));
  const { seconds } = timeline;
  return spellsOf(states, seconds).map(({ first, last }): Failure => {
    const places = states.flatMap((state, i) => (state && i >= first && i <= last ? [i] : []));
    const end = known[known.length - 1];
    return {
      run, id, kind: "wrong mode", from: seconds[first], until: seconds[last], toTheEnd: last === end, fromTheStart: first === known[0],
      why: reasonOf(run, index, places),
    };
  });
}

/** Without truth: where a run has an object on another mode than the first run. */
function disagreements(run: Run, first: Run, id: string, { seconds }: Trace): Failure[] {
  const apart = run.apart(first, id);
  if (!apart || run.error(id)) return [];
  const states = apart.angle.map((degrees, i) => (degrees === null ? undefined : degrees > RIGHT_DEG || apart.distance[i]! > RIGHT_MM));
  const known = states.flatMap((state, i) => (state === undefined ? [] : [i]));
  return spellsOf(states, seconds).map((spell): Failure => {
    const places = states.flatMap((state, i) => (state && i >= spell.first && i <= spell.last ? [i] : []));
    const [degrees, mm] = [median(places.map((i) => apart.angle[i]!)), median(places.map((i) => apart.distance[i]!))];
    return {
      run, id, kind: "other mode", from: seconds[spell.first], until: seconds[spell.last], toTheEnd: spell.last === known[known.length - 1], fromTheStart: spell.first === known[0],
      why: `the two are ${degrees.toFixed(0)} deg and ${mm.toFixed(0)} mm apart; which is right is not known (first: ${first.name})`,
    };
  });
}

/** Where others have an estimate of an object and a run has none. */
function absences(run: Run, id: string, { runs, timeline }: Comparison): Failure[] {
  const has = (one: Run) => {
    const pose = one.estimate(id)?.pose;
    return Array.from(one.frames, (frame) => (frame < 0 ? undefined : (pose?.has(frame) ?? false)));
  };
  const own = has(run);
  const others = runs.filter((other) => other !== run).map(has);
  const states = own.map((here, i) => (here === undefined ? undefined : !here && others.some((one) => one[i] === true)));
  const { seconds } = timeline;
  const last = states.reduce((most, state, i) => (state === undefined ? most : i), -1);
  const isNever = !own.some(Boolean);
  return spellsOf(states, seconds).map((spell): Failure => ({
    run, id, kind: "no estimate", from: seconds[spell.first], until: seconds[spell.last], toTheEnd: spell.last >= last, fromTheStart: isNever,
    why: isNever ? "it never has one" : "other runs have one",
  }));
}

/** Whether the truth tells of any object of a run on which mode it is. */
export const isJudged = (run: Run): boolean => run.trace.objects.some(({ id }) => run.error(id) !== undefined);

/** All failures, the longest first. */
export function failuresOf(comparison: Comparison): Failure[] {
  const { runs, ids, timeline, isOneRecording } = comparison;
  const found = runs.flatMap((run) => [
    ...run.trace.objects.flatMap((_, index) => wrongModes(run, index, timeline)),
    ...(isOneRecording ? ids.flatMap((id) => absences(run, id, comparison)) : []),
    ...(run === runs[0] || !isOneRecording ? [] : ids.flatMap((id) => disagreements(run, runs[0], id, timeline))),
  ]);
  return found.sort((a, b) => b.until - b.from - (a.until - a.from));
}

/** "tea-box on the wrong mode from 12.3 s on". */
export function failureText({ id, kind, from, until, toTheEnd, fromTheStart }: Failure): string {
  const what = { "wrong mode": "on the wrong mode", "no estimate": "without an estimate", "other mode": "on another mode than in the first run" }[kind];
  const span = toTheEnd ? `from ${from.toFixed(1)} s on` : `from ${from.toFixed(1)} to ${until.toFixed(1)} s`;
  if (fromTheStart && toTheEnd) return `${id} ${what} in all frames`;
  return `${id} ${what} ${span}`;
}
