// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Meshes of objects: translucent at the estimate, fainter as hypotheses and samples, wireframes at the ground truth.
import { type BufferGeometry, type Camera, type Color, EdgesGeometry, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, Raycaster, Vector2 } from "three";
import { type Numbers } from "../math/rotation.ts";
import type { PackedMesh } from "../payload.ts";
import type { Trace } from "../trace/trace.ts";
import { TRUTH_COLOUR } from "../ui/palette.ts";
import { Batch } from "./batch.ts";
import { meshShape } from "./shapes.ts";

const OPACITY = 0.55;
/** Seen through the recording's camera, so that its image is visible. */
const EYE_OPACITY = 0.14;
const EDGE_DEGREES = 28;
const GHOST_ORDER = 1;
const BODY_ORDER = 3;
const SAMPLES = 12;

export class Bodies {
  readonly node = new Group();
  readonly shapes: (BufferGeometry | undefined)[];
  private readonly bodies: (Batch | undefined)[];
  private readonly ghosts: (Batch | undefined)[];
  private readonly clouds: (Batch | undefined)[];
  private readonly edges: (BufferGeometry | undefined)[] = [];
  private readonly truths: (LineSegments | undefined)[] = [];
  private readonly outlines: (LineSegments | undefined)[] = [];
  private readonly targets: (Mesh | undefined)[];
  private readonly raycaster = new Raycaster();
  private readonly pointer = new Vector2();

  constructor(trace: Trace, meshes: Record<string, PackedMesh>, private readonly colours: readonly Color[]) {
    this.shapes = trace.objects.map(({ id }) => (Object.hasOwn(meshes, id) ? meshShape(id, meshes[id]) : undefined));
    this.bodies = this.shapes.map((shape) => shape && new Batch(shape, 1, { shell: true, order: BODY_ORDER }));
    this.ghosts = this.shapes.map((shape, i) => shape && new Batch(shape, trace.objects[i].hypotheses.length, { order: GHOST_ORDER }));
    this.clouds = this.shapes.map((shape) => shape && new Batch(shape, SAMPLES, { order: GHOST_ORDER }));
    this.targets = this.shapes.map((shape) => shape && new Mesh(shape, new MeshBasicMaterial()));
    for (const batch of this.all()) this.node.add(batch.mesh);
  }

  private all(): Batch[] {
    return [...this.bodies, ...this.ghosts, ...this.clouds].filter((batch) => batch !== undefined);
  }

  has(index: number): boolean {
    return this.shapes[index] !== undefined;
  }

  begin(): void {
    for (let i = 0; i < this.shapes.length; ++i) {
      this.bodies[i]?.begin();
      this.ghosts[i]?.begin();
      this.clouds[i]?.begin();
      const truth = this.truths[i];
      if (truth) truth.visible = false;
      const outline = this.outlines[i];
      if (outline) outline.visible = false;
    }
  }

  end(): void {
    for (let i = 0; i < this.shapes.length; ++i) {
      this.bodies[i]?.end();
      this.ghosts[i]?.end();
      this.clouds[i]?.end();
    }
  }

  addEstimate(index: number, p: Numbers, q: Numbers, fromEye: boolean): void {
    const body = this.bodies[index];
    const target = this.targets[index];
    if (!body || !target) return;
    body.addPose(p, q, 1, this.colours[index], fromEye ? EYE_OPACITY : OPACITY);
    target.position.set(p[0], p[1], p[2]);
    target.quaternion.set(q[0], q[1], q[2], q[3]);
    target.updateMatrixWorld();
    if (fromEye) this.addLines(this.outlines, index, p, q, this.colours[index].getStyle());
  }

  addGhost(index: number, p: Numbers, q: Numbers, opacity: number): void {
    this.ghosts[index]?.addPose(p, q, 1, this.colours[index], opacity);
  }

  /** One of the first few samples. */
  addSample(index: number, p: Numbers, q: Numbers): void {
    this.clouds[index]?.addPose(p, q, 1, this.colours[index], 0.07);
  }

  addTruth(index: number, p: Numbers, q: Numbers): void {
    this.addLines(this.truths, index, p, q, TRUTH_COLOUR);
  }

  /** Edges are found when they are first needed. */
  private addLines(list: (LineSegments | undefined)[], index: number, p: Numbers, q: Numbers, colour: string): void {
    const shape = this.shapes[index];
    if (!shape) return;
    this.edges[index] ??= new EdgesGeometry(shape, EDGE_DEGREES);
    let lines = list[index];
    if (!lines) {
      lines = new LineSegments(this.edges[index], new LineBasicMaterial({ color: colour, transparent: true, opacity: 0.9, depthTest: list !== this.outlines }));
      lines.renderOrder = list === this.outlines ? BODY_ORDER + 1 : GHOST_ORDER;
      list[index] = lines;
      this.node.add(lines);
    }
    lines.visible = true;
    lines.position.set(p[0], p[1], p[2]);
    lines.quaternion.set(q[0], q[1], q[2], q[3]);
  }

  isShown(index: number): boolean {
    return (this.bodies[index]?.mesh.count ?? 0) > 0;
  }

  /** The number of wireframes of the ground truth that are drawn. */
  get wireframes(): number {
    return this.truths.filter((lines) => lines?.visible).length;
  }

  /** The object whose mesh is nearest to the viewer at a point of the picture, from -1 to 1. */
  at(x: number, y: number, camera: Camera): number | undefined {
    this.raycaster.setFromCamera(this.pointer.set(x, y), camera);
    let found: number | undefined;
    let least = Infinity;
    this.targets.forEach((target, i) => {
      const hit = target && this.isShown(i) ? this.raycaster.intersectObject(target)[0] : undefined;
      if (!hit || hit.distance >= least) return;
      least = hit.distance;
      found = i;
    });
    return found;
  }
}
