// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Size of a run in space, and its upward direction.
import { Vector3 } from "three";
import { rotate } from "../math/rotation.ts";
import type { PoseTrack, Trace } from "../trace/trace.ts";

const SAMPLES = 400;

function sampled(track: PoseTrack | undefined, frames: number, visit: (frame: number) => void): void {
  const step = Math.max(1, Math.floor(frames / SAMPLES));
  for (let frame = 0; frame < frames; frame += step) if (track?.has(frame)) visit(frame);
}

/** The axis of the world that is nearest to the camera's average upward direction. */
export function upAxis(trace: Trace): Vector3 {
  const sum = new Vector3();
  const q = [0, 0, 0, 1];
  const up = [0, 0, 0];
  const track = trace.camera?.pose;
  sampled(track, trace.frames, (frame) => {
    track!.quaternion(frame, q);
    rotate(q, [0, -1, 0], up);
    sum.add(new Vector3(up[0], up[1], up[2]));
  });
  return nearestAxis(sum);
}

export function nearestAxis(direction: Vector3): Vector3 {
  const parts = direction.toArray();
  const axis = [0, 1, 2].reduce((best, i) => (Math.abs(parts[i]) > Math.abs(parts[best]) ? i : best), 2);
  const up = new Vector3();
  up.setComponent(axis, parts[axis] < 0 ? -1 : 1);
  return up;
}

/** Positions over the frames, without the outermost hundredth at either end of each axis. */
function positions(trace: Trace, tracks: (PoseTrack | undefined)[]): Vector3[] {
  const points: Vector3[] = [];
  const at = [0, 0, 0];
  for (const track of tracks) {
    sampled(track, trace.frames, (frame) => {
      track!.position(frame, at);
      points.push(new Vector3(at[0], at[1], at[2]));
    });
  }
  const ranges = [0, 1, 2].map((axis) => {
    const sorted = points.map((point) => point.getComponent(axis)).sort((a, b) => a - b);
    return [sorted[Math.floor(0.01 * sorted.length)], sorted[Math.ceil(0.99 * (sorted.length - 1))]];
  });
  return points.filter((point) => ranges.every(([low, high], axis) => point.getComponent(axis) >= low && point.getComponent(axis) <= high));
}

/** The extent of the objects. */
export function objectBounds(trace: Trace): Vector3[] {
  return positions(trace, trace.objects.map(({ world }) => world?.pose));
}

/** The extent of camera and objects. */
export function boundsOf(trace: Trace): Vector3[] {
  return positions(trace, [trace.camera?.pose, ...trace.objects.map(({ world }) => world?.pose)]);
}
