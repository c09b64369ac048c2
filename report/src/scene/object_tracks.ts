// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// How the scene shows tracks: paths of objects that move, and objects that are not confirmed or lost.
import { type Color, Group, type Object3D } from "three";
import type { Numbers } from "../math/rotation.ts";
import type { Trace } from "../trace/trace.ts";
import { TRUTH_COLOUR } from "../ui/palette.ts";
import { Batch } from "./batch.ts";
import { dashedPath, Path } from "./path.ts";
import { axesShape } from "./shapes.ts";

type Shape = ConstructorParameters<typeof Batch>[0];

/** The paths of the objects that move, in their colours, and the true ones dashed. */
export class ObjectPaths {
  readonly node = new Group();
  readonly truth = new Group();
  private readonly paths: { index: number; path: Path; truth: Object3D | undefined }[] = [];

  constructor(trace: Trace, colours: readonly Color[], dash: number) {
    trace.objects.forEach(({ models, world }, i) => {
      if (!models || !world) return;
      const path = new Path(world.pose, trace.frames, true);
      path.setColour(colours[i]);
      const truth = world.truth && dashedPath(world.truth, trace.frames, TRUTH_COLOUR, dash);
      this.paths.push({ index: i, path, truth });
      this.node.add(path.node);
      if (truth) this.truth.add(truth);
    });
  }

  get any(): boolean {
    return this.paths.length > 0;
  }

  update(frame: number, hidden: ReadonlySet<number>): void {
    for (const { index, path, truth } of this.paths) {
      path.node.visible = !hidden.has(index);
      if (truth) truth.visible = path.node.visible;
      path.update(frame);
    }
  }
}

/** Faint axes, and bodies, in place of the solid ones. */
export class FaintObjects {
  readonly axes: Batch;
  readonly batches: Batch[];
  private readonly bodies: (Batch | undefined)[];

  constructor(private readonly trace: Trace, shapes: readonly (Shape | undefined)[]) {
    const { length } = trace.objects;
    this.axes = new Batch(axesShape(), trace.hasTracks ? length : 0, { tintShare: 0.5 });
    this.bodies = shapes.map((shape) => (trace.hasTracks && shape ? new Batch(shape, 1) : undefined));
    this.batches = [this.axes, ...this.bodies.filter((body) => body !== undefined)];
  }

  /** Whether the object is drawn faint at a frame: its track is not confirmed, or lost. */
  has(index: number, frame: number): boolean {
    if (!this.trace.hasTracks) return false;
    const health = this.trace.healthAt(index, frame);
    return health === "lost" || health === "tentative";
  }

  add(index: number, p: Numbers, q: Numbers, unit: number, colour: Color): void {
    this.bodies[index]?.addPose(p, q, 1, colour, 0.3);
    this.axes.addPose(p, q, unit, colour, 0.45);
  }
}

const PERCENT = Array.from({ length: 101 }, (_, i) => `${i} %`);
const SPOKEN = new Set(["lost", "tentative", "inconsistent"]);

/** The labels of objects, each made once: a frame allocates nothing. */
export class ObjectNames {
  private readonly names: string[] = [];

  constructor(private readonly trace: Trace) {}

  /** The id, the weight of the leading hypothesis (-1: none), and the health of a track that is not good. */
  at(index: number, frame: number, percent: number): string {
    const { id, health } = this.trace.objects[index];
    const value = health && this.trace.hasTracks ? health[frame] : 0;
    const place = 102 * (this.trace.objects.length * value + index) + percent + 1;
    return (this.names[place] ??= id + (percent < 0 ? "" : `: ${PERCENT[percent]}`) + this.spoken(index, frame));
  }

  private spoken(index: number, frame: number): string {
    const word = this.trace.hasTracks ? this.trace.healthAt(index, frame) : "";
    return SPOKEN.has(word) ? `, ${word}` : "";
  }
}
