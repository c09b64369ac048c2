// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What happened in a run: few events, each with its duration, from thousands of frames.
import { chiSquareQuantile } from "../math/chi_square.ts";
import { fixed, percent, plural, short, time } from "../ui/numbers.ts";
import type { Deviation } from "./deviation.ts";
import { hypothesisEvents } from "./hypothesis_events.ts";
import { flips } from "./flips.ts";
import { modeEvents } from "./mode_events.ts";
import { joinAll, type Span, spansOf } from "./spans.ts";
import type { ObjectTrack, Trace } from "./trace.ts";

export const EVENT_KINDS = {
  entered: "entered",
  wrong: "on a wrong mode",
  flipped: "flip or jump",
  born: "hypothesis born",
  merged: "hypothesis merged",
  pruned: "hypothesis pruned",
  unexplained: "detections not explained",
  ambiguous: "ambiguous",
  unknown: "pose not known",
  lost: "lost",
  register: "register again",
  moved: "moved",
  beyond: "error beyond 3 sigma",
  nees: "NEES beyond its band",
} as const;
export type EventKind = keyof typeof EVENT_KINDS;

/** Kinds that say that something went wrong. */
export const BAD_KINDS: ReadonlySet<EventKind> = new Set(["wrong", "flipped", "unexplained", "lost", "register", "beyond", "nees"]);
/** Kinds in which the filter says itself that it is not sure: no fault, but worth telling. */
export const UNSURE_KINDS: ReadonlySet<EventKind> = new Set(["ambiguous", "unknown"]);

export interface RunEvent extends Span {
  kind: EventKind;
  /** The number of an object; -1: the camera. */
  entity: number;
  /** What it was, where the size alone does not tell. */
  detail?: string;
}

/** Errors and NEES of the camera (-1) and the objects, where there are any. */
export interface ErrorSeries {
  deviation(entity: number): Deviation | undefined;
  nees(entity: number): Float32Array | undefined;
}

/** The upper end of the band that holds the NEES of a consistent pose in 99.9 % of the frames. */
export const NEES_LIMIT = chiSquareQuantile(0.999, 6);
/** A NEES as large has a chance of one in a million. */
const NEES_SURE = chiSquareQuantile(1 - 1e-6, 6);
const SIGMA_LIMIT = 3;
const SIGMA_SURE = 5;
/** Fewer successive frames are what chance makes in a long run, unless they are far out; fewer detections are gross errors as a detector has them. */
const LEAST_FRAMES = 3;
const MOST_EVENTS = 300;
const NOT_EXPLAINED = new Set(["doubted", "birth", "gated", "failed"]);
const STILL = new Set(["static", "put down"]);

type Found = Omit<RunEvent, "entity">;

const named = (kind: EventKind, spans: Span[]): Found[] => spans.map((span) => ({ ...span, kind }));

/** Spans of a limit, of at least some frames or far out. */
function beyond(kind: EventKind, series: Float32Array | undefined, limit: number, sure: number, gap: number): Found[] {
  if (!series) return [];
  const spans = spansOf(series.length, (frame) => (series[frame] > limit ? series[frame] : 0), gap);
  return named(kind, spans.filter(({ count, size }) => count >= LEAST_FRAMES || size > sure));
}

/** Runs of detections that are not explained, without one between them that is. */
function unexplained(trace: Trace, { status }: ObjectTrack): Found[] {
  if (!status) return [];
  const wrong = trace.statuses.map((word) => NOT_EXPLAINED.has(word));
  const none = trace.statuses.indexOf("none");
  const out: Span[] = [];
  let run: Span | undefined;
  for (let frame = 0; frame < trace.frames; ++frame) {
    if (status[frame] === none) continue;
    if (!wrong[status[frame]]) run = undefined;
    else if (run) [run.to, run.count, run.size] = [frame, run.count + 1, run.size + 1];
    else out.push((run = { from: frame, to: frame, count: 1, peak: frame, size: 1 }));
  }
  return named("unexplained", out.filter(({ count }) => count >= LEAST_FRAMES));
}

function moved(trace: Trace, { models }: ObjectTrack, gap: number): Found[] {
  const still = models?.names.flatMap((name, k) => (STILL.has(name.replace(/ \d+$/, "")) ? [k] : [])) ?? [];
  if (!models || still.length === 0) return [];
  const moving = (frame: number) => {
    const first = models.probability(still[0], frame);
    if (first === undefined) return 0;
    return 1 - still.reduce((sum, k) => sum + (models.probability(k, frame) ?? 0), 0) - 0.5;
  };
  return named("moved", spansOf(trace.frames, moving, gap));
}

function entered(trace: Trace, { world, relative }: ObjectTrack): Found[] {
  const pose = (world ?? relative)?.pose;
  for (let frame = 0; pose && frame < trace.frames; ++frame) {
    if (pose.has(frame)) return [{ kind: "entered", from: frame, to: frame, count: 1, peak: frame, size: 1 }];
  }
  return [];
}

/** Spans of a word of health. */
function ofHealth(trace: Trace, { health }: ObjectTrack, kind: EventKind & ("lost" | "ambiguous"), gap: number): Found[] {
  const word = trace.healths.indexOf(kind);
  return health && word >= 0 ? named(kind, spansOf(trace.frames, (frame) => (health[frame] === word ? 1 : 0), gap)) : [];
}

function ofObject(trace: Trace, index: number, deviation: Deviation | undefined, gap: number): Found[] {
  const object = trace.objects[index];
  const { registerAgain } = object;
  return [
    ...entered(trace, object),
    ...flips(trace, object),
    ...hypothesisEvents(trace, object),
    ...unexplained(trace, object),
    ...modeEvents(trace, object, deviation, gap),
    ...ofHealth(trace, object, "ambiguous", gap).filter(({ count }) => count >= LEAST_FRAMES),
    ...ofHealth(trace, object, "lost", gap),
    ...(registerAgain ? named("register", spansOf(trace.frames, (frame) => registerAgain[frame], gap)) : []),
    ...moved(trace, object, gap),
  ];
}

/** Joins successive events of the same kind and object. */
function coarser(events: RunEvent[], gap: number): RunEvent[] {
  const lists = new Map<string, RunEvent[]>();
  for (const event of events) {
    const key = `${event.entity} ${event.kind}`;
    const list = lists.get(key);
    if (list) list.push(event);
    else lists.set(key, [event]);
  }
  return [...lists.values()].flatMap((list) => joinAll(list.sort((a, b) => a.from - b.from), gap));
}

/** All events of a run by time; where there were too many, successive ones are joined across longer and longer gaps. */
export function eventsOf(trace: Trace, errors: ErrorSeries): RunEvent[] {
  let gap = Math.max(3, Math.round(0.005 * trace.frames));
  let events: RunEvent[] = [];
  for (let entity = -1; entity < trace.objects.length; ++entity) {
    const found = [
      ...(entity < 0 ? [] : ofObject(trace, entity, errors.deviation(entity), gap)),
      ...beyond("beyond", errors.deviation(entity)?.largest, SIGMA_LIMIT, SIGMA_SURE, gap),
      ...beyond("nees", errors.nees(entity), NEES_LIMIT, NEES_SURE, gap),
    ];
    for (const event of found) events.push({ ...event, entity });
  }
  events = coarser(events, gap);
  while (events.length > MOST_EVENTS && gap < trace.frames) events = coarser(events, (gap *= 2));
  const kinds = Object.keys(EVENT_KINDS);
  return events.sort((a, b) => a.from - b.from || a.entity - b.entity || kinds.indexOf(a.kind) - kinds.indexOf(b.kind));
}

/** How long something was so [s]: until the frame in which it is not any more. */
export function durationOf(trace: Trace, { from, to }: Span): number {
  return trace.seconds[Math.min(to + 1, trace.frames - 1)] - trace.seconds[from];
}

const lasting = (trace: Trace, span: Span) => `for ${time(durationOf(trace, span))}`;

/** An event in words, without its object and time. */
export function describe(trace: Trace, event: RunEvent): string {
  const { kind, count, size, detail, from, to } = event;
  const many = count > 1 ? `${count} times in ${time(trace.seconds[to] - trace.seconds[from])}, at most ` : "";
  switch (kind) {
    case "entered":
      return "entered: its first estimate";
    case "flipped":
      return `the estimate ${many}${detail ?? ""}`;
    case "born":
      return count > 1 ? `${count} hypotheses born, one that came to ${percent(size)}` : `a hypothesis born, ${detail ?? ""}; it came to ${percent(size)}`;
    case "merged":
      return count > 1 ? `${count} hypotheses merged into others` : `a hypothesis of up to ${percent(size)} merged into another`;
    case "pruned":
      return count > 1 ? `${count} hypotheses pruned, one that had ${percent(size)}` : `a hypothesis pruned that had up to ${percent(size)}`;
    case "unexplained":
      return `${plural(count, "detection")} that the leading hypothesis does not explain, ${lasting(trace, event)}`;
    case "wrong":
      return `on a wrong mode ${lasting(trace, event)}${detail === undefined ? "" : `: ${detail} from the truth`}`;
    case "ambiguous":
      return `ambiguous ${lasting(trace, event)}`;
    case "unknown":
      return `${detail ?? "pose not known"} (3 sigma), ${lasting(trace, event)}`;
    case "lost":
      return `lost ${lasting(trace, event)}${to === trace.frames - 1 ? ", until the end" : ", then found again"}`;
    case "register":
      return `should be registered again, ${lasting(trace, event)}`;
    case "moved":
      return `moved ${lasting(trace, event)}`;
    case "beyond":
      return `error beyond 3 sigma in ${plural(count, "frame")}, up to ${short(size)} sigma`;
    case "nees":
      return `NEES above ${fixed(NEES_LIMIT, 1)} (99.9 % band) in ${plural(count, "frame")}, up to ${short(size)}`;
  }
}
