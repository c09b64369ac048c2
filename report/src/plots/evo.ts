// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The statistics of evo (github.com/MichaelGrupp/evo): APE, RPE by frames, time and distance, alignment by Umeyama.
import { eigenOf } from "../math/eigen.ts";
import { angleBetween, DEGREES, multiply, type Numbers, type Quat, rotate, type Vec3 } from "../math/rotation.ts";
import type { PoseTrack } from "../trace/trace.ts";

/** Poses of an estimate and its truth in the frames that have both. */
export interface Pairs {
  count: number;
  seconds: Float64Array;
  /** Three numbers per pose [m]. */
  places: Float64Array;
  truePlaces: Float64Array;
  /** Four numbers per pose. */
  turns: Float64Array;
  trueTurns: Float64Array;
}

export function pairsOf(track: PoseTrack, truth: PoseTrack, seconds: ArrayLike<number>): Pairs {
  const frames: number[] = [];
  for (let frame = 0; frame < seconds.length; ++frame) if (track.has(frame) && truth.has(frame)) frames.push(frame);
  const n = frames.length;
  const [places, truePlaces] = [new Float64Array(3 * n), new Float64Array(3 * n)];
  const [turns, trueTurns] = [new Float64Array(4 * n), new Float64Array(4 * n)];
  const p = [0, 0, 0];
  const q = [0, 0, 0, 1];
  const read = (from: PoseTrack, frame: number, i: number, place: Float64Array, turn: Float64Array) => {
    from.position(frame, p);
    from.quaternion(frame, q);
    place.set(p, 3 * i);
    turn.set(q, 4 * i);
  };
  frames.forEach((frame, i) => {
    read(track, frame, i, places, turns);
    read(truth, frame, i, truePlaces, trueTurns);
  });
  return { count: n, seconds: Float64Array.from(frames, (frame) => seconds[frame]), places, truePlaces, turns, trueTurns };
}

export interface Motion {
  turn: Quat;
  shift: Vec3;
}

const LEAST_SPREAD_M = 1e-3;

/**
 * The motion without scale that brings the estimated positions nearest to the true ones (Umeyama 1991; the rotation by
 * Horn's quaternions). Undefined where they are too much at one place, or on one line, to tell a rotation.
 */
export function umeyama({ count, places, truePlaces }: Pairs): Motion | undefined {
  const [a, b] = [[0, 0, 0], [0, 0, 0]];
  for (let i = 0; i < 3 * count; ++i) {
    a[i % 3] += places[i] / count;
    b[i % 3] += truePlaces[i] / count;
  }
  const s = new Float64Array(9);
  const own = new Float64Array(9);
  for (let k = 0; k < count; ++k) {
    for (let i = 0; i < 3; ++i) {
      const from = places[3 * k + i] - a[i];
      for (let j = 0; j < 3; ++j) {
        s[3 * i + j] += from * (truePlaces[3 * k + j] - b[j]);
        own[3 * i + j] += (from * (places[3 * k + j] - a[j])) / count;
      }
    }
  }
  if (!(count >= 3) || Math.sqrt(Math.max(0, eigenOf(own, 3).values[1])) < LEAST_SPREAD_M) return undefined;
  const [xx, xy, xz, yx, yy, yz, zx, zy, zz] = s;
  const horn = [
    xx + yy + zz, yz - zy, zx - xz, xy - yx, yz - zy, xx - yy - zz, xy + yx, zx + xz,
    zx - xz, xy + yx, yy - xx - zz, yz + zy, xy - yx, zx + xz, yz + zy, zz - xx - yy,
  ];
  const [w, x, y, z] = eigenOf(horn, 4).vectors[0];
  const turn: Quat = [x, y, z, w];
  const moved: Vec3 = [0, 0, 0];
  rotate(turn, a, moved);
  return { turn, shift: [b[0] - moved[0], b[1] - moved[1], b[2] - moved[2]] };
}

/** The estimates after a motion. */
export function aligned(pairs: Pairs, { turn, shift }: Motion): Pairs {
  const places = new Float64Array(pairs.places.length);
  const turns = new Float64Array(pairs.turns.length);
  const p: Vec3 = [0, 0, 0];
  for (let i = 0; i < pairs.count; ++i) {
    rotate(turn, pairs.places.subarray(3 * i, 3 * i + 3), p);
    for (let k = 0; k < 3; ++k) places[3 * i + k] = p[k] + shift[k];
    multiply(turn, pairs.turns.subarray(4 * i, 4 * i + 4), turns.subarray(4 * i, 4 * i + 4));
  }
  return { ...pairs, places, turns };
}

/** Errors by pose or pair of poses: distance [mm] and angle [deg]. */
export interface Errors {
  distance: Float64Array;
  angle: Float64Array;
}

/** Absolute pose errors. */
export function ape({ count, places, truePlaces, turns, trueTurns }: Pairs): Errors {
  const distance = new Float64Array(count);
  const angle = new Float64Array(count);
  for (let i = 0; i < count; ++i) {
    const k = 3 * i;
    distance[i] = 1000 * Math.hypot(places[k] - truePlaces[k], places[k + 1] - truePlaces[k + 1], places[k + 2] - truePlaces[k + 2]);
    angle[i] = DEGREES * angleBetween(turns.subarray(4 * i, 4 * i + 4), trueTurns.subarray(4 * i, 4 * i + 4));
  }
  return { distance, angle };
}

export type Step = { frames: number } | { seconds: number } | { metres: number };

/** The length of the true path up to every pose [m]. */
export function trueLengths({ count, truePlaces }: Pairs): Float64Array {
  const lengths = new Float64Array(count);
  for (let i = 1; i < count; ++i) {
    const k = 3 * i;
    lengths[i] = lengths[i - 1] + Math.hypot(truePlaces[k] - truePlaces[k - 3], truePlaces[k + 1] - truePlaces[k - 2], truePlaces[k + 2] - truePlaces[k - 1]);
  }
  return lengths;
}

/** What turns and shifts from pose i to pose j, seen from pose i. */
function between(places: Float64Array, turns: Float64Array, i: number, j: number, turn: Numbers, shift: Numbers): void {
  const back = [-turns[4 * i], -turns[4 * i + 1], -turns[4 * i + 2], turns[4 * i + 3]];
  multiply(back, turns.subarray(4 * j, 4 * j + 4), turn);
  rotate(back, [places[3 * j] - places[3 * i], places[3 * j + 1] - places[3 * i + 1], places[3 * j + 2] - places[3 * i + 2]], shift);
}

/** Relative pose errors: from every pose to the first one that is a step away along the truth. */
export function rpe(pairs: Pairs, step: Step): Errors {
  const along = "frames" in step ? undefined : "seconds" in step ? pairs.seconds : trueLengths(pairs);
  const size = "frames" in step ? step.frames : "seconds" in step ? step.seconds : step.metres;
  const [distance, angle]: [number[], number[]] = [[], []];
  const [turn, shift, trueTurn, trueShift] = [[0, 0, 0, 1], [0, 0, 0], [0, 0, 0, 1], [0, 0, 0]];
  for (let i = 0, j = 0; i < pairs.count; ++i) {
    if (along) while (j < pairs.count && along[j] - along[i] < size * (1 - 1e-6)) ++j;
    else j = i + size;
    if (j >= pairs.count) break;
    between(pairs.places, pairs.turns, i, j, turn, shift);
    between(pairs.truePlaces, pairs.trueTurns, i, j, trueTurn, trueShift);
    angle.push(DEGREES * angleBetween(turn, trueTurn));
    // The translation of D_true^-1 D_est has the length of the difference of the two shifts.
    distance.push(1000 * Math.hypot(shift[0] - trueShift[0], shift[1] - trueShift[1], shift[2] - trueShift[2]));
  }
  return { distance: Float64Array.from(distance), angle: Float64Array.from(angle) };
}

/** Steps of RPE that a run is long enough for. */
export function stepsFor(pairs: Pairs): { name: string; step: Step }[] {
  const time = pairs.count > 1 ? pairs.seconds[pairs.count - 1] - pairs.seconds[0] : 0;
  const length = pairs.count > 1 ? trueLengths(pairs)[pairs.count - 1] : 0;
  return [
    { name: "1 frame", step: { frames: 1 } },
    ...[0.1, 1, 5, 10, 60].filter((seconds) => seconds <= 0.5 * time).map((seconds) => ({ name: `${seconds} s`, step: { seconds } })),
    ...[0.01, 0.1, 0.5, 1, 5, 10, 100].filter((metres) => metres <= 0.5 * length && metres >= 1e-3 * length).map((metres) => ({ name: `${metres} m`, step: { metres } })),
  ];
}
