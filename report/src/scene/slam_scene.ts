// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { Color, Group, Matrix4, Vector3 } from "three";
import { cholesky } from "../math/linear.ts";
import { multiply, rotate, samePose } from "../math/rotation.ts";
import type { PackedMesh } from "../payload.ts";
import type { Estimate, Trace } from "../trace/trace.ts";
import { colourOf, TRUTH_COLOUR } from "../ui/palette.ts";
import { onTheme, themeColour } from "../ui/theme.ts";
import { Batch } from "./batch.ts";
import { boundsOf, objectBounds, upAxis } from "./extent.ts";
import type { Layers, ShownPose } from "./layers.ts";
import { FaintObjects, ObjectNames, ObjectPaths } from "./object_tracks.ts";
import { dashedPath, Path } from "./path.ts";
import { axesShape, ballShape, frustum, grid, gridStep, meshShape } from "./shapes.ts";
import { type View, Viewport } from "./viewport.ts";

const LEAST_SHOWN = 5e-4;
const LEAST_LABELLED = 0.02;
const PERCENT = Array.from({ length: 101 }, (_, i) => `${i} %`);

/** Camera, objects and hypotheses of a run at one frame. */
export class SlamScene {
  readonly viewport: Viewport;
  readonly layers: Layers = { truth: true, ellipsoids: true, hypotheses: true, detections: false, labels: true, paths: true };
  readonly gridStep: number;
  private readonly cameraNode = new Group();
  private readonly frustum: ReturnType<typeof frustum>;
  private readonly objectNodes: Group[];
  private readonly path: Path | undefined;
  readonly objectPaths: ObjectPaths;
  private readonly truthPath: Group = new Group();
  private readonly axes: Batch;
  private readonly balls: Batch;
  private readonly glass: Batch;
  private readonly ghosts: Batch;
  private readonly truths: Batch;
  private readonly detections: Batch;
  private readonly batches: Batch[];
  private readonly bodies: (Batch | undefined)[];
  private readonly bodyGhosts: (Batch | undefined)[];
  readonly faint: FaintObjects;
  private readonly colours: Color[];
  private readonly grey = new Color(TRUTH_COLOUR);
  private readonly ink = new Color();
  private inkText = "";
  private readonly names: ObjectNames;
  private readonly unit: number;
  private readonly eye = new Matrix4();
  private frame = 0;
  // Scratch memory, so that a frame allocates nothing.
  private readonly p = new Float64Array(3);
  private readonly q = new Float64Array(4);
  private readonly p2 = new Float64Array(3);
  private readonly q2 = new Float64Array(4);
  private readonly cameraP = new Float64Array(3);
  private readonly cameraQ = new Float64Array(4);
  private readonly matrix = new Float64Array(9);
  private readonly root = new Float64Array(9);

  constructor(private readonly trace: Trace, meshes: Record<string, PackedMesh>) {
    const up = upAxis(trace);
    this.viewport = new Viewport("Camera path, objects and their uncertainty", up);
    const bounds = boundsOf(trace);
    this.viewport.setBounds(bounds);
    const size = this.viewport.size;
    this.viewport.setNear(objectBounds(trace));
    this.unit = 0.05 * size;
    this.gridStep = gridStep(size);
    this.colours = trace.objects.map((_, i) => new Color(colourOf(i)));
    const count = trace.objects.length;
    const slots = trace.objects.reduce((sum, object) => sum + object.hypotheses.length, trace.cameraHypotheses.length);
    this.axes = new Batch(axesShape(), count, { solid: true });
    this.balls = new Batch(ballShape(), count, { solid: true });
    this.glass = new Batch(ballShape(), count + 1, { glass: true, onTop: true });
    this.ghosts = new Batch(axesShape(0.05), slots, { tintShare: 0.75 });
    this.truths = new Batch(axesShape(0.035), count + 1, { tintShare: 0.85 });
    this.detections = new Batch(axesShape(0.03), count, { tintShare: 1 });
    const shapes = trace.objects.map(({ id }) => (Object.hasOwn(meshes, id) ? meshShape(id, meshes[id]) : undefined));
    this.bodies = shapes.map((shape) => shape && new Batch(shape, 1, { solid: true }));
    this.bodyGhosts = shapes.map((shape, i) => shape && new Batch(shape, trace.objects[i].hypotheses.length));
    this.faint = new FaintObjects(trace, shapes);
    this.names = new ObjectNames(trace);
    const { scene } = this.viewport;
    this.batches = [this.axes, this.balls, this.glass, this.ghosts, this.truths, this.detections, ...this.faint.batches];
    for (const batch of [...this.batches, ...this.bodies, ...this.bodyGhosts]) if (batch) scene.add(batch.mesh);
    this.objectNodes = trace.objects.map(() => new Group());
    scene.add(this.cameraNode, this.truthPath, ...this.objectNodes);
    this.frustum = frustum(1.4 * this.unit);
    this.cameraNode.add(this.frustum);
    if (trace.camera) {
      this.path = new Path(trace.camera.pose, trace.frames);
      scene.add(this.path.node);
      const { truth } = trace.camera;
      if (truth) this.truthPath.add(dashedPath(truth, trace.frames, TRUTH_COLOUR, 0.02 * size));
    }
    this.objectPaths = new ObjectPaths(trace, this.colours, 0.01 * size);
    scene.add(this.objectPaths.node);
    this.truthPath.add(this.objectPaths.truth);
    const ground = Math.min(0, ...bounds.map((point) => point.dot(up)));
    scene.add(grid(this.viewport.centre, up, size, ground));
    onTheme(() => this.takeColours());
    this.takeColours();
    this.viewport.onLeaveEye = () => this.update(this.frame);
    this.viewport.look("fit");
  }

  private takeColours(): void {
    this.inkText = themeColour("--ink");
    this.ink.set(this.inkText);
    this.path?.setColour(this.ink);
    this.frustum.material.color.copy(this.ink);
    this.viewport.invalidate();
  }

  look(view: View): void {
    this.viewport.look(view, this.eye);
    this.update(this.frame);
  }

  /** Shows or hides a layer, and draws. */
  setLayer(layer: keyof Layers, on: boolean): void {
    this.layers[layer] = on;
    this.update(this.frame);
    this.viewport.invalidate();
  }

  /** The pose at which an object, or the camera, is drawn. */
  shown(index: number | "camera"): ShownPose | undefined {
    const node = index === "camera" ? this.cameraNode : this.objectNodes[index];
    if (!node || node.userData["absent"]) return undefined;
    return { position: node.position.toArray(), quaternion: node.quaternion.toArray() };
  }

  /** Number of hypotheses drawn as ghosts. */
  get ghostCount(): number {
    return this.bodyGhosts.reduce((sum, batch) => sum + (batch?.mesh.count ?? 0), this.ghosts.mesh.count);
  }

  /** Number of ellipsoids drawn. */
  get ellipsoidCount(): number {
    return this.glass.mesh.count;
  }

  /** The objects that are drawn as meshes. */
  get bodyIds(): string[] {
    return this.trace.objects.filter((_, i) => this.bodies[i]?.mesh.visible).map(({ id }) => id);
  }

  update(frame: number): void {
    this.frame = frame;
    const { viewport, layers } = this;
    viewport.labels.clear();
    for (const batch of this.batches) batch.begin();
    this.updateCamera(frame);
    // The names of all objects are placed before the weights of their ghosts.
    for (let i = 0; i < this.trace.objects.length; ++i) this.updateObject(i, frame);
    for (let i = 0; i < this.trace.objects.length; ++i) this.addGhosts(i, frame);
    for (const batch of this.batches) batch.end();
    this.truthPath.visible = layers.truth && !viewport.fromEye;
    this.path?.update(frame);
    if (this.path) this.path.node.visible = !viewport.fromEye;
    this.objectPaths.update(frame);
    this.objectPaths.node.visible = layers.paths;
  }

  private updateCamera(frame: number): void {
    const { camera } = this.trace;
    const here = camera !== undefined && camera.pose.has(frame);
    this.cameraNode.visible = here && !this.viewport.fromEye;
    this.cameraNode.userData["absent"] = !here;
    if (!camera) return;
    if (here) {
      camera.pose.position(frame, this.cameraP);
      camera.pose.quaternion(frame, this.cameraQ);
      place(this.cameraNode, this.cameraP, this.cameraQ);
      this.eye.compose(this.cameraNode.position, this.cameraNode.quaternion, ONE);
    }
    if (this.viewport.fromEye) return;
    if (here) this.addEllipsoid(camera, frame, this.cameraP, this.grey);
    this.addTruth(camera, frame);
    if (!this.layers.hypotheses) return;
    for (const slot of this.trace.cameraHypotheses) {
      if (!slot.pose.has(frame) || slot.probability(frame) < LEAST_SHOWN) continue;
      slot.pose.position(frame, this.p);
      slot.pose.quaternion(frame, this.q);
      this.ghosts.addPose(this.p, this.q, this.unit, this.ink, opacity(slot.probability(frame)));
    }
  }

  private updateObject(index: number, frame: number): void {
    const object = this.trace.objects[index];
    const { world } = object;
    const colour = this.colours[index];
    const body = this.bodies[index];
    const here = world !== undefined && world.pose.has(frame);
    this.objectNodes[index].userData["absent"] = !here;
    body?.begin();
    if (here) {
      world.pose.position(frame, this.p);
      world.pose.quaternion(frame, this.q);
      place(this.objectNodes[index], this.p, this.q);
      if (this.faint.has(index, frame)) this.faint.add(index, this.p, this.q, this.unit, colour);
      else {
        body?.addPose(this.p, this.q, 1, colour, 1);
        this.axes.addPose(this.p, this.q, this.unit, colour, 1);
        this.balls.addPose(this.p, this.q, 0.1 * this.unit, colour, 1);
      }
      if (this.layers.labels) {
        const { p } = this;
        this.viewport.labels.add(p[0], p[1], p[2], this.names.at(index, frame, this.leadingPercent(index, frame)), this.inkText);
      }
      this.addEllipsoid(world, frame, this.p, colour);
    }
    body?.end();
    if (world) this.addTruth(world, frame);
    this.addDetection(index, frame);
  }

  private leadingPercent(index: number, frame: number): number {
    if (!this.layers.hypotheses) return -1;
    for (const slot of this.trace.objects[index].hypotheses) {
      if (!slot.pose.has(frame)) continue;
      slot.pose.position(frame, this.p2);
      slot.pose.quaternion(frame, this.q2);
      if (samePose(this.p, this.q, this.p2, this.q2)) return Math.round(100 * slot.probability(frame));
    }
    return -1;
  }

  private addGhosts(index: number, frame: number): void {
    const { hypotheses, world } = this.trace.objects[index];
    const here = world !== undefined && world.pose.has(frame);
    if (here) {
      world.pose.position(frame, this.p);
      world.pose.quaternion(frame, this.q);
    }
    const body = this.bodyGhosts[index];
    body?.begin();
    for (let k = 0; this.layers.hypotheses && k < hypotheses.length; ++k) {
      const slot = hypotheses[k];
      if (!slot.pose.has(frame)) continue;
      const weight = slot.probability(frame);
      if (weight < LEAST_SHOWN) continue;
      slot.pose.position(frame, this.p2);
      slot.pose.quaternion(frame, this.q2);
      if (here && samePose(this.p, this.q, this.p2, this.q2)) continue;
      const colour = this.colours[index];
      if (body) body.addPose(this.p2, this.q2, 1, colour, 0.5 * opacity(weight));
      else this.ghosts.addPose(this.p2, this.q2, 1.15 * this.unit, colour, opacity(weight));
      if (this.layers.labels && weight >= LEAST_LABELLED) {
        const text = PERCENT[Math.round(100 * weight)];
        this.viewport.labels.add(this.p2[0], this.p2[1], this.p2[2], text, this.inkText);
      }
    }
    body?.end();
  }

  private addEllipsoid(estimate: Estimate, frame: number, at: Float64Array, colour: Color): void {
    if (!this.layers.ellipsoids || !estimate.hasCovariance) return;
    estimate.covariance(frame, this.matrix);
    for (let i = 0; i < 3; ++i) this.matrix[4 * i] += 1e-10;
    cholesky(this.matrix, 3, this.root);
    this.glass.addLinear(at, this.root, 3, colour, 0.7);
  }

  private addTruth(estimate: Estimate, frame: number): void {
    if (!this.layers.truth || !estimate.truth?.has(frame)) return;
    estimate.truth.position(frame, this.p2);
    estimate.truth.quaternion(frame, this.q2);
    this.truths.addPose(this.p2, this.q2, 1.3 * this.unit, this.grey, 0.95);
  }

  /** T_world_camera T_camera_object. */
  private addDetection(index: number, frame: number): void {
    const { detection } = this.trace.objects[index];
    if (!this.layers.detections || !detection?.has(frame) || this.cameraNode.userData["absent"]) return;
    detection.position(frame, this.p2);
    detection.quaternion(frame, this.q2);
    rotate(this.cameraQ, this.p2, this.p2);
    for (let i = 0; i < 3; ++i) this.p2[i] += this.cameraP[i];
    multiply(this.cameraQ, this.q2, this.q2);
    this.detections.addPose(this.p2, this.q2, 1.6 * this.unit, this.colours[index], 0.9);
  }
}

function place(node: Group, position: Float64Array, quaternion: Float64Array): void {
  node.position.fromArray(position);
  node.quaternion.fromArray(quaternion);
}

const ONE = new Vector3(1, 1, 1);

/** Small weights stay visible. */
function opacity(weight: number): number {
  return 0.12 + 0.8 * Math.sqrt(weight);
}

