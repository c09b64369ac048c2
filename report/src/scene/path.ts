// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import {
  BufferAttribute, BufferGeometry, type Color, Group, Line, LineBasicMaterial, LineDashedMaterial,
} from "three";
import { Line2 } from "three/examples/jsm/lines/Line2.js";
import { LineGeometry } from "three/examples/jsm/lines/LineGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import type { PoseTrack } from "../trace/trace.ts";

/** Positions of the frames that have one, and their number up to each frame. */
export function pathPoints(track: PoseTrack, frames: number): { points: Float32Array; counts: Int32Array } {
  const points: number[] = [];
  const counts = new Int32Array(frames);
  const at = [0, 0, 0];
  for (let frame = 0; frame < frames; ++frame) {
    if (track.has(frame)) {
      track.position(frame, at);
      points.push(at[0], at[1], at[2]);
    }
    counts[frame] = points.length / 3;
  }
  return { points: new Float32Array(points), counts };
}

/** A path in space: a thin line as a whole, a thick line up to the shown frame. */
export class Path {
  readonly node = new Group();
  private readonly thin = new LineBasicMaterial({ transparent: true, opacity: 0.35 });
  private readonly thick = new LineMaterial({ linewidth: 2.5 });
  private readonly past = new LineGeometry();
  private readonly counts: Int32Array;

  constructor(track: PoseTrack, frames: number) {
    const { points, counts } = pathPoints(track, frames);
    this.counts = counts;
    if (points.length < 6) return;
    this.past.setPositions(points);
    const line = new Line2(this.past, this.thick);
    line.frustumCulled = false;
    this.node.add(new Line(lineGeometry(points), this.thin), line);
  }

  setColour(colour: Color): void {
    this.thin.color.copy(colour);
    this.thick.color.copy(colour);
  }

  update(frame: number): void {
    this.past.instanceCount = Math.max(0, this.counts[frame] - 1);
  }
}

function lineGeometry(points: Float32Array): BufferGeometry {
  return new BufferGeometry().setAttribute("position", new BufferAttribute(points, 3));
}

export function dashedPath(track: PoseTrack, frames: number, colour: string, dash: number): Line {
  const { points } = pathPoints(track, frames);
  const material = new LineDashedMaterial({ color: colour, dashSize: dash, gapSize: 0.6 * dash });
  return new Line(lineGeometry(points), material).computeLineDistances();
}
