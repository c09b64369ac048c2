// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Runs over one recording on one timeline. A frame of one run stands beside those of the others that have its stamp.
import { errorNorms, spreadOf, type TrackView } from "../plots/series.ts";
import { BadPayload, type JsonObject, type PackedRun } from "../payload.ts";
import { type Estimate, type PoseTrack, readTrace, Trace } from "../trace/trace.ts";
import { colourOf } from "../ui/palette.ts";
import { safePath } from "../ui/data_table.ts";
import { otherRecording } from "./recordings.ts";

export type Values = (number | null)[];

/** Stamps that differ by less are the same [s]. */
const SAME_STAMP = 5e-4;

export interface Norms {
  /** [mm] */
  distance: Values;
  /** [deg] */
  angle: Values;
}

export class Run {
  readonly colour: string;
  /** The frame that is shown at a frame of the timeline: the last one so far; -1 before the run begins and after it has ended. */
  readonly shown: Int32Array;
  readonly metrics: JsonObject;
  private readonly errors = new Map<string, Norms | undefined>();
  private readonly sigmas = new Map<string, Norms | undefined>();
  private readonly differences = new Map<string, Norms>();

  constructor(
    readonly index: number,
    readonly name: string,
    readonly trace: Trace,
    /** Its own page, as a path below this one's folder. */
    readonly report: string | undefined,
    readonly documents: JsonObject,
    /** Its frame at a frame of the timeline, or -1. */
    readonly frames: Int32Array,
    /** Its first and last moment on the timeline [s]. */
    readonly span: readonly [number, number],
  ) {
    this.colour = colourOf(index);
    const end = frames.lastIndexOf(trace.frames - 1);
    let last = -1;
    this.shown = frames.map((frame, i) => (i > end ? -1 : (last = frame < 0 ? last : frame)));
    const metrics = documents["metrics.json"];
    this.metrics = typeof metrics === "object" && metrics !== null && !Array.isArray(metrics) ? metrics : {};
  }

  object(id: string): Trace["objects"][number] | undefined {
    return this.trace.objects.find((object) => object.id === id);
  }

  /** The camera in the world, an object as seen from the camera. */
  estimate(id: string | undefined): Estimate | undefined {
    return id === undefined ? this.trace.camera : this.object(id)?.relative;
  }

  /** Values of the run's frames, at the frames of the timeline. */
  spread(values: Values): Values {
    return Array.from(this.frames, (frame) => (frame < 0 ? null : values[frame]));
  }

  private norms(cache: Map<string, Norms | undefined>, id: string | undefined, make: (estimate: Estimate) => Norms | undefined): Norms | undefined {
    const key = id === undefined ? "" : `=${id}`;
    if (!cache.has(key)) {
      const estimate = this.estimate(id);
      const own = estimate && make(estimate);
      cache.set(key, own && { distance: this.spread(own.distance), angle: this.spread(own.angle) });
    }
    return cache.get(key);
  }

  /** Errors over the timeline; undefined without truth. Undefined id: the camera. */
  error(id: string | undefined): Norms | undefined {
    return this.norms(this.errors, id, ({ pose, truth }) => truth && errorNorms(pose, truth, this.trace.frames));
  }

  /** How far its estimate is from that of another run, where both have one. */
  apart(other: Run, id: string | undefined): Norms | undefined {
    const [own, theirs] = [this.estimate(id)?.pose, other.estimate(id)?.pose];
    if (!own || !theirs) return undefined;
    const key = `${other.index}${id === undefined ? "" : `=${id}`}`;
    const known = this.differences.get(key);
    if (known) return known;
    const pairs = this.frames.map((frame, i) => (frame >= 0 && other.frames[i] >= 0 ? frame : -1));
    const at = (track: PoseTrack, frames: Int32Array): TrackView => ({
      has: (i) => pairs[i] >= 0 && track.has(frames[i]), position: (i, out) => track.position(frames[i], out), quaternion: (i, out) => track.quaternion(frames[i], out),
    });
    const found = errorNorms(at(own, this.frames), at(theirs, other.frames), this.frames.length);
    this.differences.set(key, found);
    return found;
  }

  /** What the norm of a consistent error exceeds in 0.27 % of the frames, over the timeline. */
  sigma(id: string | undefined): Norms | undefined {
    return this.norms(this.sigmas, id, (estimate) => spreadOf(estimate, this.trace.frames));
  }
}

export interface Comparison {
  runs: Run[];
  /** A trace with the stamps and objects of all runs, and nothing in it. */
  timeline: Trace;
  /** The ids of all objects, by their number on the page. */
  ids: string[];
  hasTruth: boolean;
  /** Whether frames of one run may be compared with those of another. */
  isOneRecording: boolean;
  /** What a reader must know before comparing. */
  cautions: string[];
}

/** All stamps in their order, those of one moment once. */
export function unionOf(stamps: readonly (readonly number[])[]): number[] {
  const all = stamps.flat().sort((a, b) => a - b);
  return all.filter((stamp, i) => i === 0 || stamp - all[i - 1] > SAME_STAMP);
}

/** For every moment of a timeline the frame with its stamp, or -1. */
export function placesOf(timeline: readonly number[], stamps: readonly number[]): Int32Array {
  const places = new Int32Array(timeline.length).fill(-1);
  let k = 0;
  for (let i = 0; i < timeline.length; ++i) {
    while (k < stamps.length && stamps[k] < timeline[i] - SAME_STAMP) ++k;
    if (k < stamps.length && Math.abs(stamps[k] - timeline[i]) <= 2 * SAME_STAMP) places[i] = k++;
  }
  return places;
}

/** Names that tell the runs apart. */
export function distinctNames(names: readonly string[]): string[] {
  return names.map((name, i) => {
    const before = names.slice(0, i).filter((other) => other === name).length;
    return names.filter((other) => other === name).length > 1 ? `${name} (${before + 1})` : name;
  });
}

function hashes(run: Run): Set<string> {
  const provenance = (run.metrics["provenance"] ?? {}) as JsonObject;
  const inputs = Array.isArray(provenance["inputs"]) ? provenance["inputs"] : [];
  return new Set(inputs.map((input) => String((input as JsonObject)?.["sha256"] ?? "")).filter((hash) => hash !== ""));
}

/** The same run under two names. */
function twice(runs: Run[]): string[] {
  const idOf = (run: Run) => (typeof run.metrics["run"] === "string" && run.metrics["run"] !== "" ? run.metrics["run"] : undefined);
  return runs.flatMap((run, i) => {
    const same = runs.slice(0, i).find((other) => idOf(other) !== undefined && idOf(other) === idOf(run));
    return same ? [`${same.name} and ${run.name} are the same run: that they agree says nothing.`] : [];
  });
}

function cautionsOf(runs: Run[], seconds: number, apart: string[]): string[] {
  const cautions: string[] = [...apart, ...twice(runs)];
  if (apart.length === 0 && runs.some(({ span: [from, until] }) => from > 0.02 * seconds || until < 0.98 * seconds)) {
    const list = runs.map(({ name, span: [from, until], trace }) => `${name} ${trace.frames} frames, ${from.toFixed(1)} to ${until.toFixed(1)} s`).join("; ");
    cautions.push(`The runs are of different length (${list}): they are compared over the frames that all have.`);
  }
  const known = runs.map(hashes).filter((set) => set.size > 0);
  if (apart.length === 0 && known.length > 1 && known.some((set) => ![...set].some((hash) => known[0].has(hash)))) {
    cautions.push("The runs were made from different input files: they may be of different recordings.");
  }
  const without = runs.filter(({ trace }) => !trace.hasTruth).map(({ name }) => name);
  if (without.length === runs.length) cautions.push("There is no ground truth: which run is better cannot be said, only how they differ.");
  else if (without.length > 0) cautions.push(`There is no ground truth in ${without.join(", ")}: of these no error is known.`);
  return cautions;
}

export async function readComparison(packed: readonly PackedRun[]): Promise<Comparison> {
  const names = distinctNames(packed.map(({ name }) => name));
  // All at once; of several that are damaged the first is named, and not the one that fails first.
  const read = await Promise.allSettled(packed.map(({ trace }) => readTrace(trace)));
  const traces = read.map((result, i) => {
    if (result.status === "fulfilled") return result.value;
    const error: unknown = result.reason;
    throw error instanceof BadPayload ? new BadPayload(`Run ${names[i]}: ${error.message}`) : error;
  });
  const stamps = unionOf(traces.map(({ head }) => head.stamps_s));
  const ids = [...new Set(traces.flatMap(({ head }) => head.order))];
  const timeline = new Trace({ name: "", method: "", order: ids, frames: stamps.length, stamps_s: stamps, columns: [], data: "" }, new Map());
  const runs = traces.map((trace, i) => {
    const own = trace.head.stamps_s;
    const span = [own[0] - stamps[0], own[own.length - 1] - stamps[0]] as const;
    return new Run(i, names[i], trace, safePath(packed[i].report), packed[i].documents, placesOf(stamps, own), span);
  });
  const apart = runs.slice(1).flatMap((run) => {
    const why = otherRecording(runs[0], run);
    return why === undefined ? [] : [`${runs[0].name} and ${run.name} ${why}: they are of different recordings, and are neither tested nor ranked against each other.`];
  });
  const cautions = cautionsOf(runs, timeline.seconds[timeline.frames - 1], apart);
  return { runs, timeline, ids, hasTruth: runs.some(({ trace }) => trace.hasTruth), isOneRecording: apart.length === 0, cautions };
}
