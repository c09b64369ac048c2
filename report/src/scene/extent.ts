// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Size of a run in space, and its upward direction.
import { Box3, Vector3 } from "three";
import { rotate } from "../math/rotation.ts";
import { median } from "../math/statistics.ts";
import type { PoseTrack, Trace } from "../trace/trace.ts";

const SAMPLES = 120;
/** A track that leaves its usual range by more than these shares of range and scene has run away, and is not fitted. */
const OWN_SHARE = 3;
const SCENE_SHARE = 0.5;

function sampled(track: PoseTrack | undefined, frames: number, visit: (frame: number) => void): void {
  const step = Math.max(1, Math.floor(frames / SAMPLES));
  for (let frame = 0; frame < frames; frame += step) if (track?.has(frame)) visit(frame);
  if ((frames - 1) % step !== 0 && track?.has(frames - 1)) visit(frames - 1);
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

interface Placed {
  frame: number;
  point: Vector3;
}

function placesOf(track: PoseTrack | undefined, frames: number): Placed[] {
  const at = [0, 0, 0];
  const places: Placed[] = [];
  sampled(track, frames, (frame) => {
    track!.position(frame, at);
    places.push({ frame, point: new Vector3(at[0], at[1], at[2]) });
  });
  return places;
}

/** The middle nine tenths of the points, axis by axis. */
function usual(points: Placed[]): Box3 {
  const box = new Box3();
  for (let axis = 0; axis < 3; ++axis) {
    const sorted = points.map(({ point }) => point.getComponent(axis)).sort((a, b) => a - b);
    box.min.setComponent(axis, sorted[Math.floor(0.05 * (sorted.length - 1))]);
    box.max.setComponent(axis, sorted[Math.ceil(0.95 * (sorted.length - 1))]);
  }
  return box;
}

/** The points of several tracks; of each without those where it has run away. */
export function trimmed(tracks: Placed[][]): Placed[][] {
  const boxes = tracks.map((points) => (points.length > 0 ? usual(points) : new Box3()));
  const scene = boxes.reduce((all, box) => all.union(box), new Box3());
  const floor = scene.isEmpty() ? 0 : SCENE_SHARE * scene.getSize(new Vector3()).length();
  return tracks.map((points, k) => {
    if (points.length === 0) return points;
    const range = boxes[k].getSize(new Vector3());
    const wide = boxes[k].clone();
    const margin = new Vector3(...range.toArray().map((size) => Math.max(OWN_SHARE * size, floor)));
    wide.expandByVector(margin);
    return points.filter(({ point }) => wide.containsPoint(point));
  });
}

const tracksOf = (trace: Trace) =>
  [trace.camera?.pose, trace.camera?.truth, ...trace.objects.flatMap(({ world }) => [world?.pose, world?.truth])];

const bare = (tracks: Placed[][]) => tracks.flatMap((points) => points.map(({ point }) => point));

/** The extent of camera and objects, without what is drawn around them. */
export function boundsOf(trace: Trace): Vector3[] {
  return bare(trimmed(tracksOf(trace).map((track) => placesOf(track, trace.frames))));
}

/** The extent of the objects. */
export function objectBounds(trace: Trace): Vector3[] {
  return bare(trimmed(trace.objects.map(({ world }) => placesOf(world?.pose, trace.frames))));
}

/** What is drawn around the poses. */
export interface Around {
  /** The corners of the camera's pyramid, in its frame. */
  corners: readonly number[][];
  /** How far an object reaches, with its axes and ellipsoid. */
  reach: (index: number, frame: number) => number;
}

/** The extent of all that is drawn: camera with pyramid, objects with ellipsoids, and their ground truth. */
export function fullBounds(trace: Trace, { corners, reach }: Around): Vector3[] {
  const tracks = trimmed(tracksOf(trace).map((track) => placesOf(track, trace.frames)));
  const points: Vector3[] = [];
  const q = [0, 0, 0, 1];
  const out = [0, 0, 0];
  tracks.forEach((track, k) => {
    for (const { frame, point } of track) {
      points.push(point);
      if (k === 0) {
        trace.camera!.pose.quaternion(frame, q);
        for (const corner of corners) {
          rotate(q, corner, out);
          points.push(new Vector3(out[0], out[1], out[2]).add(point));
        }
      } else if (k >= 2 && k % 2 === 0) {
        const far = reach((k - 2) / 2, frame);
        for (let axis = 0; axis < 6; ++axis) points.push(point.clone().setComponent(axis % 3, point.getComponent(axis % 3) + (axis < 3 ? far : -far)));
      }
    }
  });
  return points;
}

/** The length of axes with which objects do not cover each other: by how near they are at the last frames. */
export function axisLength(trace: Trace, size: number): number {
  const last = trace.objects.flatMap(({ world }) => placesOf(world?.pose, trace.frames).slice(-1)).map(({ point }) => point);
  const nearest = last.map((point) => Math.min(...last.filter((other) => other !== point).map((other) => other.distanceTo(point))));
  const usualGap = nearest.length > 0 ? median(nearest) : Infinity;
  return Math.max(0.02 * size, Math.min(0.05 * size, 0.4 * usualGap));
}
