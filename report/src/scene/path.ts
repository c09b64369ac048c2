// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import {
  BufferAttribute, BufferGeometry, type Color, Group, Line, LineBasicMaterial, LineDashedMaterial, LineSegments,
} from "three";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import type { PoseTrack } from "../trace/trace.ts";

/** Positions of the frames that have one. */
function pathPoints(track: PoseTrack, frames: number): Float32Array {
  const points: number[] = [];
  const at = [0, 0, 0];
  for (let frame = 0; frame < frames; ++frame) {
    if (!track.has(frame)) continue;
    track.position(frame, at);
    points.push(at[0], at[1], at[2]);
  }
  return new Float32Array(points);
}

/**
 * Pairs of points between frames that have one, and the number of pairs up to each frame. `broken`: only between a frame and
 * the next, so that there is no line to where the track begins anew.
 */
function pathPairs(track: PoseTrack, frames: number, broken: boolean): { points: Float32Array; counts: Int32Array } {
  const points: number[] = [];
  const counts = new Int32Array(frames);
  const last = [0, 0, 0];
  const at = [0, 0, 0];
  let before = -1;
  for (let frame = 0; frame < frames; ++frame) {
    if (track.has(frame)) {
      track.position(frame, at);
      if (before >= 0 && (!broken || before === frame - 1)) points.push(...last, ...at);
      for (let i = 0; i < 3; ++i) last[i] = at[i];
      before = frame;
    }
    counts[frame] = points.length / 6;
  }
  return { points: new Float32Array(points), counts };
}

/** A path in space: a thin line as a whole, a thick line up to the shown frame. */
export class Path {
  readonly node = new Group();
  private readonly thin = new LineBasicMaterial({ transparent: true, opacity: 0.35 });
  private readonly thick = new LineMaterial({ linewidth: 2.5 });
  private readonly past = new LineSegmentsGeometry();
  private readonly counts: Int32Array;

  constructor(track: PoseTrack, frames: number, broken = false) {
    const { points, counts } = pathPairs(track, frames, broken);
    this.counts = counts;
    if (points.length < 6) return;
    this.past.setPositions(points);
    const line = new LineSegments2(this.past, this.thick);
    line.frustumCulled = false;
    this.node.add(new LineSegments(lineGeometry(points), this.thin), line);
  }

  setColour(colour: Color): void {
    this.thin.color.copy(colour);
    this.thick.color.copy(colour);
  }

  update(frame: number): void {
    this.past.instanceCount = this.counts[frame];
  }
}

function lineGeometry(points: Float32Array): BufferGeometry {
  return new BufferGeometry().setAttribute("position", new BufferAttribute(points, 3));
}

export function dashedPath(track: PoseTrack, frames: number, colour: string, dash: number): Line {
  const points = pathPoints(track, frames);
  const material = new LineDashedMaterial({ color: colour, dashSize: dash, gapSize: 0.6 * dash });
  return new Line(lineGeometry(points), material).computeLineDistances();
}
