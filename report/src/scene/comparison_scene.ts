// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The runs of a comparison in one scene: paths of the camera and poses of the objects, each in the colour of its run.
import { Color, Group, Vector3 } from "three";
import { lensCorners } from "./lens.ts";
import type { Comparison, Run } from "../compare/runs.ts";
import type { PoseTrack } from "../trace/trace.ts";
import { TRUTH_COLOUR } from "../ui/palette.ts";
import { onTheme, themeColour } from "../ui/theme.ts";
import { Batch } from "./batch.ts";
import { boundsOf, upAxis } from "./extent.ts";
import { dashedPath, Path } from "./path.ts";
import { axesShape, ballShape, frustum, grid } from "./shapes.ts";
import { Viewport } from "./viewport.ts";

export class ComparisonScene {
  readonly viewport: Viewport;
  /** The extent of all runs. */
  readonly bounds: Vector3[];
  private readonly paths: (Path | undefined)[];
  private readonly cameras: ReturnType<typeof frustum>[];
  private readonly axes: Batch;
  private readonly balls: Batch;
  private readonly truths: Batch;
  private readonly colours: Color[];
  private readonly grey = new Color(TRUTH_COLOUR);
  private readonly unit: number;
  private readonly shown: Set<Run>;
  private inkText = themeColour("--ink");
  private frame = 0;
  // Scratch memory, so that a frame allocates nothing.
  private readonly p = new Float64Array(3);
  private readonly q = new Float64Array(4);

  constructor(private readonly comparison: Comparison) {
    const { runs } = comparison;
    this.shown = new Set(runs);
    const up = upAxis(runs[0].trace);
    this.viewport = new Viewport("Camera paths and objects of all runs, each in the colour of its run", up);
    const bounds = runs.flatMap(({ trace }) => boundsOf(trace));
    this.bounds = bounds;
    this.viewport.setBounds(bounds);
    const size = this.viewport.size;
    this.unit = 0.05 * size;
    this.colours = runs.map(({ colour }) => new Color(colour));
    const count = runs.reduce((sum, { trace }) => sum + trace.objects.length, 0);
    this.axes = new Batch(axesShape(0.06), count, { solid: true, tintShare: 0.7 });
    this.balls = new Batch(ballShape(), count, { solid: true });
    this.truths = new Batch(axesShape(0.035), comparison.ids.length, { tintShare: 0.85 });
    this.paths = runs.map(({ trace }) => trace.camera && new Path(trace.camera.pose, trace.frames));
    this.cameras = runs.map(({ trace }) => frustum(1.2 * this.unit, lensCorners(trace.head.intrinsics)));
    const { scene } = this.viewport;
    scene.add(this.axes.mesh, this.balls.mesh, this.truths.mesh, ...this.cameras);
    this.paths.forEach((path, i) => {
      path?.setColour(this.colours[i]);
      if (path) scene.add(path.node);
      this.cameras[i].material.color.copy(this.colours[i]);
    });
    this.addTruth(0.02 * size);
    scene.add(grid(this.viewport.centre, up, size, Math.min(0, ...bounds.map((point) => point.dot(up)))));
    onTheme(() => {
      this.inkText = themeColour("--ink");
      this.update(this.frame);
    });
    this.viewport.look("fit");
  }

  private addTruth(dash: number): void {
    const group = new Group();
    const run = this.comparison.runs.find(({ trace }) => trace.camera?.truth);
    if (run) group.add(dashedPath(run.trace.camera!.truth!, run.trace.frames, TRUTH_COLOUR, dash));
    this.viewport.scene.add(group);
  }

  setShown(run: Run, on: boolean): void {
    if (on) this.shown.add(run);
    else this.shown.delete(run);
    this.update(this.frame);
  }

  /** The runs whose camera is drawn at the shown frame. */
  get drawn(): string[] {
    return this.comparison.runs.filter((_, i) => this.cameras[i].visible).map(({ name }) => name);
  }

  /** A frame of the timeline; a run that has ended or has not begun is not drawn. */
  update(at: number): void {
    this.frame = at;
    const { runs } = this.comparison;
    const batches = [this.axes, this.balls, this.truths];
    this.viewport.labels.clear();
    for (const batch of batches) batch.begin();
    runs.forEach((run, i) => this.addRun(run, i, run.shown[at]));
    for (const id of this.comparison.ids) this.addTrueObject(id, at);
    for (const batch of batches) batch.end();
    this.viewport.invalidate();
  }

  private addRun(run: Run, index: number, frame: number): void {
    const isShown = this.shown.has(run);
    const path = this.paths[index];
    const camera = this.cameras[index];
    camera.visible = isShown && frame >= 0 && (run.trace.camera?.pose.has(frame) ?? false);
    if (path) path.node.visible = isShown;
    if (frame < 0) return;
    path?.update(frame);
    if (camera.visible) {
      this.take(run.trace.camera!.pose, frame);
      camera.position.fromArray(this.p);
      camera.quaternion.fromArray(this.q);
    }
    if (!isShown) return;
    for (const { world } of run.trace.objects) {
      if (!world?.pose.has(frame)) continue;
      this.take(world.pose, frame);
      this.axes.addPose(this.p, this.q, this.unit, this.colours[index], 1);
      this.balls.addPose(this.p, this.q, 0.13 * this.unit, this.colours[index], 1);
    }
  }

  /** The truth of an object, by any of the runs, and its name. */
  private addTrueObject(id: string, at: number): void {
    for (const run of this.comparison.runs) {
      const frame = run.shown[at];
      const world = frame < 0 ? undefined : run.object(id)?.world;
      const track = world?.truth?.has(frame) ? world.truth : world?.pose;
      if (!track?.has(frame)) continue;
      this.take(track, frame);
      if (track === world?.truth) this.truths.addPose(this.p, this.q, 1.3 * this.unit, this.grey, 0.95);
      this.viewport.labels.add(this.p[0], this.p[1], this.p[2], id, { colour: this.inkText, entity: this.comparison.ids.indexOf(id), isName: true });
      return;
    }
  }

  private take(track: PoseTrack, frame: number): void {
    track.position(frame, this.p);
    track.quaternion(frame, this.q);
  }
}
