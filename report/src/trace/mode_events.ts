// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Where an object is on a wrong mode, and where the filter says itself that it does not know the pose.
import { DEGREES } from "../math/rotation.ts";
import { median } from "../math/statistics.ts";
import { short } from "../ui/numbers.ts";
import type { Deviation } from "./deviation.ts";
import { differenceOf, inWords } from "./difference.ts";
import type { RunEvent } from "./events.ts";
import { REACH_DEG, REACH_M, rightAt } from "./right_mode.ts";
import { type Span, spansOf } from "./spans.ts";
import type { Estimate, ObjectTrack, Trace } from "./trace.ts";

type Found = Omit<RunEvent, "entity">;

/** Shorter spells are not worth words [s]. */
const LEAST_SECONDS = 0.5;
const LEAST_FRAMES = 3;
/** An object out of sight is not known any more where 3 sigma are as many times those of a usual frame, and more than this [m]. */
const TIMES_USUAL = 5;
const LEAST_WIDTH = 0.01;

/** Three sigmas of position [m] and rotation [deg], the widest of each; NaN where they are not known. */
function widthsOf(estimate: Estimate, frames: number): { place: Float32Array; turn: Float32Array } {
  const [place, turn] = [new Float32Array(frames).fill(NaN), new Float32Array(frames).fill(NaN)];
  const sd = [0, 0, 0];
  for (let frame = 0; frame < frames; ++frame) {
    if (!estimate.pose.has(frame)) continue;
    estimate.positionSdAt(frame, sd);
    place[frame] = 3 * Math.max(...sd);
    estimate.rotationSd(frame, sd);
    turn[frame] = 3 * DEGREES * Math.max(...sd);
  }
  return { place, turn };
}

/** The width beyond which the position of an object that may have moved is not known. */
function limitOf(place: Float32Array): number {
  const known = place.filter((width) => !Number.isNaN(width));
  return Math.min(REACH_M, Math.max(LEAST_WIDTH, TIMES_USUAL * (known.length > 0 ? median(known) : 0)));
}

function fromTruth({ pose, truth }: Estimate, frame: number): string {
  const [p, t] = [[0, 0, 0], [0, 0, 0]];
  const [q, r] = [[0, 0, 0, 1], [0, 0, 0, 1]];
  pose.position(frame, p);
  truth!.position(frame, t);
  pose.quaternion(frame, q);
  truth!.quaternion(frame, r);
  return inWords(differenceOf(t, r, p, q));
}

/** An error that its own 3 sigma cover is no wrong mode: the pose is not known. */
export function modeEvents(trace: Trace, object: ObjectTrack, deviation: Deviation | undefined, gap: number): Found[] {
  const { world, relative, models, detection } = object;
  const estimate = relative?.truth ? relative : world?.truth ? world : (relative ?? world);
  if (!estimate) return [];
  const right = rightAt(estimate);
  const { place, turn } = widthsOf(estimate, trace.frames);
  const limit = limitOf(place);
  const isCovered = (frame: number) => deviation !== undefined && deviation.largest[frame] <= 3;
  const wrong = (frame: number) => (right(frame) === false && !isCovered(frame) ? 1 : 0);
  const unknown = (frame: number) => {
    const isHidden = models !== undefined && detection?.has(frame) === false && place[frame] > limit;
    const isFar = right(frame) === false;
    if ((!isHidden && !isFar) || wrong(frame)) return 0;
    return Math.max(place[frame] / REACH_M, isFar ? turn[frame] / REACH_DEG : 0);
  };
  const isLong = ({ from, to, count }: Span) => count >= LEAST_FRAMES && trace.seconds[to] - trace.seconds[from] >= LEAST_SECONDS;
  const spans = (sizeAt: (frame: number) => number) => spansOf(trace.frames, sizeAt, gap).filter(isLong);
  const width = ({ peak, size }: Span) => (size <= place[peak] / REACH_M ? `position not known to better than ${short(1000 * place[peak])} mm` : `rotation not known to better than ${short(turn[peak])} deg`);
  return [
    ...spans(wrong).map((span): Found => ({ ...span, kind: "wrong", detail: fromTruth(estimate, span.peak) })),
    ...spans(unknown).map((span): Found => ({ ...span, kind: "unknown", detail: width(span) })),
  ];
}
