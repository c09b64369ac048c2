// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Whether runs are of one recording, from what their traces have of it: the true poses and the detections at stamps of both.
import { angleBetween, DEGREES } from "../math/rotation.ts";
import type { TrackView } from "../plots/series.ts";
import type { Run } from "./runs.ts";

/** Poses are stored in steps; what differs by less is the same [mm, deg]. */
const SAME_MM = 0.5;
const SAME_DEG = 0.2;
/** A detection may be of another object in another run, or of none; of another recording all are others. */
const LEAST_SHARED = 0.5;

type Pairs = readonly (readonly [number, number])[];

const [P, T, Q, R] = [[0, 0, 0], [0, 0, 0], [0, 0, 0, 1], [0, 0, 0, 1]];

function isSame(a: TrackView, i: number, b: TrackView, k: number): boolean {
  a.position(i, P);
  b.position(k, T);
  if (1000 * Math.hypot(P[0] - T[0], P[1] - T[1], P[2] - T[2]) > SAME_MM) return false;
  a.quaternion(i, Q);
  b.quaternion(k, R);
  return angleBetween(Q, R) * DEGREES <= SAME_DEG;
}

function hasOtherTruth(a: Run, b: Run, pairs: Pairs): boolean {
  return [undefined, ...a.trace.objects.map(({ id }) => id)].some((id) => {
    const [own, other] = [a.estimate(id)?.truth, b.estimate(id)?.truth];
    return own !== undefined && other !== undefined && pairs.some(([i, k]) => own.has(i) && other.has(k) && !isSame(own, i, other, k));
  });
}

/** Where one run has a detection of an object, the other has it too, of whichever object. */
function hasOtherDetections(a: Run, b: Run, pairs: Pairs): boolean {
  const tracks = (run: Run) => run.trace.objects.flatMap(({ detection }) => detection ?? []);
  const [own, others] = [tracks(a), tracks(b)];
  let [count, shared] = [0, 0];
  for (const [i, k] of pairs) {
    const there = others.filter((other) => other.has(k));
    if (there.length === 0) continue;
    for (const track of own) {
      if (!track.has(i)) continue;
      ++count;
      if (there.some((other) => isSame(track, i, other, k))) ++shared;
    }
  }
  return count > 0 && shared < LEAST_SHARED * count;
}

/** In what two runs show that they are of different recordings; undefined if in nothing. */
export function otherRecording(a: Run, b: Run): string | undefined {
  const pairs = Array.from(a.frames, (i, place) => [i, b.frames[place]] as const).filter(([i, k]) => i >= 0 && k >= 0);
  if (pairs.length === 0) return "have no stamp in common";
  if (hasOtherTruth(a, b, pairs)) return "have different true poses at the same stamps";
  return hasOtherDetections(a, b, pairs) ? "have different detections at the same stamps" : undefined;
}
