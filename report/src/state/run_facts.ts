// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What is worked out of a whole run, once and when it is asked for.
import { type Deviation, deviationOf } from "../trace/deviation.ts";
import type { Json } from "../payload.ts";
import { eventsOf, type RunEvent } from "../trace/events.ts";
import { estimateOf, neesOf, nisOf, type Of, squaresOf } from "../trace/squares.ts";
import type { Estimate, Trace } from "../trace/trace.ts";
import { findingIn, NEVER, NO_ERROR, NO_TRUTH, type Verdict, verdictOfErrors, verdictOfInnovations } from "../trace/verdict.ts";

/** Makes a value at the first call. */
function once<T>(make: (entity: number) => T): (entity: number) => T {
  const made = new Map<number, T>();
  return (entity) => {
    if (!made.has(entity)) made.set(entity, make(entity));
    return made.get(entity)!;
  };
}

export interface WorstMoment {
  frame: number;
  /** What is worst there: the error in sigmas, the probability of the mode, or the width of the position [mm]. */
  of: "error" | "mode" | "spread";
  size: number;
}

export class RunFacts {
  constructor(readonly trace: Trace, private readonly metrics?: Json) {}

  /** The frame of reference in which an object is judged: the camera's where its truth is known, for that has no drift in it. */
  readonly frameOf = once((entity): "world" | "relative" => {
    const object = this.trace.objects[entity];
    return object?.relative?.truth ? "relative" : "world";
  });

  judged(entity: number): Estimate | undefined {
    return entity < 0 ? this.trace.camera : this.trace.objects[entity][this.frameOf(entity)];
  }

  readonly deviation = once((entity): Deviation | undefined => {
    const estimate = this.judged(entity);
    return estimate && deviationOf(estimate, this.trace.frames);
  });

  readonly nees = once((entity) => squaresOf(this.trace, neesOf(this.trace, entity, this.frameOf(entity))));

  /** What covariances are worth in the frame of reference in which an object is judged. */
  verdict(entity: number): Verdict {
    return this.verdicts[this.frameOf(entity)](entity);
  }

  /** The same in a given one. */
  verdictIn(entity: number, of: Of): Verdict {
    return this.verdicts[entity < 0 ? "world" : of](entity);
  }

  private readonly verdicts = {
    relative: once((entity) => this.judge(entity, "relative")),
    world: once((entity) => this.judge(entity, "world")),
  };

  private judge(entity: number, of: Of): Verdict {
    const { trace } = this;
    const estimate = estimateOf(trace, entity, of);
    const deviation = estimate && deviationOf(estimate, trace.frames);
    if (deviation) {
      const isStated = entity < 0 || of === "relative";
      const stated = isStated ? findingIn(this.metrics, trace.objects[entity]?.id) : undefined;
      return verdictOfErrors(stated, squaresOf(trace, neesOf(trace, entity, of)), deviation);
    }
    const nis = squaresOf(trace, nisOf(trace, entity));
    return (nis && verdictOfInnovations(nis)) ?? this.silence(entity, estimate);
  }

  /** Why nothing can be said of a pose. */
  private silence(entity: number, estimate: Estimate | undefined): Verdict {
    const { trace } = this;
    const { world, relative } = trace.objects[entity] ?? { world: trace.camera, relative: undefined };
    const isEstimated = [world, relative].some((one) => one && trace.seconds.some((_, frame) => one.pose.has(frame)));
    if (!isEstimated) return NEVER;
    return estimate?.truth ? NO_ERROR : NO_TRUTH;
  }

  private found: RunEvent[] | undefined;

  get events(): RunEvent[] {
    return (this.found ??= eventsOf(this.trace, this));
  }

  eventsOfEntity(entity: number): RunEvent[] {
    return this.events.filter((event) => event.entity === entity);
  }

  /** The mean over the frames of the doubt about the mode, and of the largest sigma of the position [m]. */
  readonly doubt = once((entity) => {
    const { frames } = this.trace;
    const object = this.trace.objects[entity];
    const estimate = object?.world ?? object?.relative ?? this.trace.camera;
    const sd = [0, 0, 0];
    let [doubt, spread, count] = [0, 0, 0];
    for (let frame = 0; frame < frames; ++frame) {
      if (!estimate?.pose.has(frame)) continue;
      ++count;
      doubt += 1 - (object?.modeProbability?.(frame) ?? 1) * (object?.existence?.(frame) ?? 1);
      estimate.positionSdAt(frame, sd);
      spread += Math.max(sd[0], sd[1], sd[2]) || 0;
    }
    return { mode: doubt / Math.max(1, count), spread: spread / Math.max(1, count) };
  });

  /** The objects, the most uncertain of the run first. */
  get byDoubt(): number[] {
    const order = this.trace.objects.map((_, i) => i);
    // Differences of a hundredth in probability are not worth an order.
    const rank = (i: number) => Math.round(100 * this.doubt(i).mode);
    return order.sort((a, b) => rank(b) - rank(a) || this.doubt(b).spread - this.doubt(a).spread || a - b);
  }

  /** The moment of the largest error in sigmas; without truth of the least sure mode, or of the widest covariance. */
  readonly worst = once((entity): WorstMoment | undefined => {
    const deviation = this.deviation(entity);
    if (deviation) return largestOf("error", this.trace.frames, (frame) => deviation.largest[frame]);
    const mode = this.trace.objects[entity]?.modeProbability;
    if (mode) {
      const least = largestOf("mode", this.trace.frames, (frame) => 1 - (mode(frame) ?? NaN));
      return least && { ...least, size: 1 - least.size };
    }
    const estimate = this.judged(entity);
    const sd = [0, 0, 0];
    return largestOf("spread", this.trace.frames, (frame) => {
      if (!estimate?.hasPositionSd || !estimate.pose.has(frame)) return NaN;
      estimate.positionSdAt(frame, sd);
      return 1000 * Math.max(sd[0], sd[1], sd[2]);
    });
  });
}

function largestOf(of: WorstMoment["of"], frames: number, at: (frame: number) => number): WorstMoment | undefined {
  let worst: WorstMoment | undefined;
  for (let frame = 0; frame < frames; ++frame) {
    const size = at(frame);
    if (size > (worst?.size ?? -Infinity)) worst = { frame, of, size };
  }
  return worst;
}
