// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Objects at a frame: estimates, hypotheses, ground truth, detections, and what they are called.
import { Color, Group } from "three";
import { multiply, type Numbers, rotate, samePose } from "../math/rotation.ts";
import { CAMERA, type RunState } from "../state/run_state.ts";
import type { Estimate, Trace } from "../trace/trace.ts";
import { colourOf, TRUTH_COLOUR } from "../ui/palette.ts";
import { Batch } from "./batch.ts";
import type { Bodies } from "./bodies.ts";
import type { CameraPart } from "./camera_part.ts";
import type { LabelLayer, LabelStyle } from "./labels.ts";
import type { Layers } from "./layers.ts";
import { FaintObjects, ObjectNames } from "./object_tracks.ts";
import type { Picks } from "./picks.ts";
import { axesShape, ballShape } from "./shapes.ts";
import type { UncertaintyPart } from "./uncertainty_part.ts";

const LEAST_SHOWN = 5e-4;
const LEAST_LABELLED = 0.02;
/** The weight of such a hypothesis is written even where there is no room beside it. */
const LIKELY = 0.2;
const SELECTED_SIZE = 1.25;
const PERCENT = Array.from({ length: 101 }, (_, i) => `${i} %`);

interface Styles {
  name: LabelStyle;
  strong: LabelStyle;
  part: LabelStyle;
  minor: LabelStyle;
  truth: LabelStyle;
}

function stylesOf(entity: number, colour: string): Styles {
  return {
    name: { colour, entity, isName: true },
    strong: { colour, entity, isName: true, isStrong: true },
    part: { colour, entity },
    minor: { colour, entity, isMinor: true },
    truth: { colour: TRUTH_COLOUR, entity },
  };
}

export class ObjectPart {
  readonly node = new Group();
  readonly faint: FaintObjects;
  readonly ghosts: Batch;
  readonly cameraStyles: Styles;
  private readonly axes: Batch;
  private readonly balls: Batch;
  private readonly truths: Batch;
  private readonly detections: Batch;
  private readonly batches: Batch[];
  private readonly styles: Styles[];
  private readonly names: ObjectNames;
  private readonly lateNames: string[];
  private readonly grey = new Color(TRUTH_COLOUR);
  /** Poses at the frame, and whether there is one and it is shown. */
  readonly positions: Float64Array[];
  readonly quaternions: Float64Array[];
  readonly isHere: boolean[];
  private readonly p = new Float64Array(3);
  private readonly q = new Float64Array(4);

  constructor(
    private readonly state: RunState, private readonly trace: Trace, private readonly layers: Layers, private readonly labels: LabelLayer,
    private readonly picks: Picks, private readonly camera: CameraPart, private readonly bodies: Bodies,
    private readonly uncertainty: UncertaintyPart, private readonly colours: readonly Color[], private readonly unit: number,
  ) {
    const count = trace.objects.length;
    const slots = trace.objects.reduce((sum, object) => sum + object.hypotheses.length, trace.cameraHypotheses.length);
    this.axes = new Batch(axesShape(), count, { solid: true });
    this.balls = new Batch(ballShape(), count, { solid: true });
    this.ghosts = new Batch(axesShape(0.05), slots, { tintShare: 0.6, order: 1 });
    this.truths = new Batch(axesShape(0.035), count + 1, { tintShare: 0.85, order: 1 });
    this.detections = new Batch(axesShape(0.03), count, { tintShare: 1, order: 1 });
    this.faint = new FaintObjects(trace, bodies.shapes);
    this.batches = [this.axes, this.balls, this.ghosts, this.truths, this.detections, ...this.faint.batches];
    for (const batch of this.batches) this.node.add(batch.mesh);
    this.styles = trace.objects.map((_, i) => stylesOf(i, colourOf(i)));
    this.cameraStyles = stylesOf(CAMERA, TRUTH_COLOUR);
    this.names = new ObjectNames(trace);
    this.lateNames = trace.objects.map(({ id }) => `${id}: ground truth, no estimate`);
    this.positions = trace.objects.map(() => new Float64Array(3));
    this.quaternions = trace.objects.map(() => new Float64Array([0, 0, 0, 1]));
    this.isHere = trace.objects.map(() => false);
  }

  read(frame: number): void {
    this.trace.objects.forEach(({ world }, i) => {
      this.isHere[i] = world !== undefined && world.pose.has(frame) && !this.state.hidden.has(i);
      if (!this.isHere[i]) return;
      world!.pose.position(frame, this.positions[i]);
      world!.pose.quaternion(frame, this.quaternions[i]);
    });
  }

  begin(): void {
    for (const batch of this.batches) batch.begin();
  }

  end(): void {
    for (const batch of this.batches) batch.end();
  }

  add(index: number, frame: number, fromEye: boolean): void {
    if (this.isHere[index]) this.addEstimate(index, frame, fromEye);
    if (this.state.hidden.has(index)) return;
    const { world } = this.trace.objects[index];
    if (world) this.addTruth(world, index, frame);
    this.addDetection(index, frame);
  }

  private addEstimate(index: number, frame: number, fromEye: boolean): void {
    const [p, q, colour] = [this.positions[index], this.quaternions[index], this.colours[index]];
    const isSelected = this.state.selected === index;
    const size = (isSelected ? SELECTED_SIZE : 1) * this.unit;
    if (this.faint.has(index, frame)) this.faint.add(index, p, q, size, colour);
    else {
      this.bodies.addEstimate(index, p, q, fromEye);
      this.axes.addPose(p, q, size, colour, 1);
      this.balls.addPose(p, q, 0.045 * this.unit, colour, 1);
    }
    this.picks.add(index, "estimate", -1, p, q, size);
    this.uncertainty.add(index, frame, p, q, colour, isSelected);
  }

  /** The names, which find room before the weights of hypotheses. */
  addName(index: number, frame: number): void {
    if (!this.layers.labels || this.state.hidden.has(index)) return;
    const style = this.styles[index];
    if (this.isHere[index]) {
      const p = this.positions[index];
      const isSelected = this.state.selected === index;
      this.labels.add(p[0], p[1], p[2], this.names.at(index, frame, this.layers.hypotheses ? this.leadingPercent(index, frame) : -1), isSelected ? style.strong : style.name);
      if (isSelected) this.uncertainty.addLengths(this.labels, p, style.part);
      return;
    }
    // The ground truth of what was not seen so far would be nameless axes.
    const { world } = this.trace.objects[index];
    if (!this.layers.truth || !world?.truth?.has(frame)) return;
    world.truth.position(frame, this.p);
    this.labels.add(this.p[0], this.p[1], this.p[2], this.lateNames[index], style.truth);
  }

  /** The weight of the hypothesis that is the estimate; -1 where it is the only one that the filter can have, since its weight says nothing then. */
  leadingPercent(index: number, frame: number): number {
    const { hypotheses, modeProbability } = this.trace.objects[index];
    if (hypotheses.length < 2 && modeProbability?.(frame) === undefined) return -1;
    for (const slot of hypotheses) {
      if (!slot.pose.has(frame)) continue;
      slot.pose.position(frame, this.p);
      slot.pose.quaternion(frame, this.q);
      if (samePose(this.positions[index], this.quaternions[index], this.p, this.q)) return Math.round(100 * slot.probability(frame));
    }
    return -1;
  }

  addGhosts(index: number, frame: number): void {
    if (!this.layers.hypotheses || this.state.hidden.has(index)) return;
    const { hypotheses } = this.trace.objects[index];
    for (let k = 0; k < hypotheses.length; ++k) {
      const slot = hypotheses[k];
      if (!slot.pose.has(frame)) continue;
      const weight = slot.probability(frame);
      if (weight < LEAST_SHOWN) continue;
      slot.pose.position(frame, this.p);
      slot.pose.quaternion(frame, this.q);
      if (this.isHere[index] && samePose(this.positions[index], this.quaternions[index], this.p, this.q)) continue;
      this.bodies.addGhost(index, this.p, this.q, 0.4 * opacity(weight));
      this.ghosts.addPose(this.p, this.q, 1.15 * this.unit, this.colours[index], opacity(weight));
      this.picks.add(index, "hypothesis", k, this.p, this.q, 1.15 * this.unit);
      if (this.layers.labels && weight >= LEAST_LABELLED) {
        const { part, minor } = this.styles[index];
        const style = this.state.selected === index || weight >= LIKELY ? part : minor;
        this.labels.add(this.p[0], this.p[1], this.p[2], PERCENT[Math.round(100 * weight)], style);
      }
    }
  }

  addCameraGhosts(frame: number, ink: Color): void {
    if (!this.layers.hypotheses) return;
    for (const slot of this.trace.cameraHypotheses) {
      if (!slot.pose.has(frame) || slot.probability(frame) < LEAST_SHOWN) continue;
      slot.pose.position(frame, this.p);
      slot.pose.quaternion(frame, this.q);
      this.ghosts.addPose(this.p, this.q, this.unit, ink, opacity(slot.probability(frame)));
    }
  }

  addTruth(estimate: Estimate, entity: number, frame: number): void {
    if (!this.layers.truth || !estimate.truth?.has(frame)) return;
    estimate.truth.position(frame, this.p);
    estimate.truth.quaternion(frame, this.q);
    this.truths.addPose(this.p, this.q, 1.3 * this.unit, this.grey, 0.95);
    this.picks.add(entity, "truth", -1, this.p, this.q, 1.3 * this.unit);
    if (entity !== CAMERA) this.bodies.addTruth(entity, this.p, this.q);
  }

  /** T_world_camera T_camera_object. */
  detectionPose(index: number, frame: number, p: Numbers, q: Numbers): boolean {
    const { detection } = this.trace.objects[index];
    if (!detection?.has(frame) || !this.camera.here) return false;
    detection.position(frame, p);
    detection.quaternion(frame, q);
    rotate(this.camera.quaternion, p, p);
    for (let i = 0; i < 3; ++i) p[i] += this.camera.position[i];
    multiply(this.camera.quaternion, q, q);
    return true;
  }

  private addDetection(index: number, frame: number): void {
    if (!this.layers.detections || !this.detectionPose(index, frame, this.p, this.q)) return;
    this.detections.addPose(this.p, this.q, 1.6 * this.unit, this.colours[index], 0.9);
    this.picks.add(index, "detection", -1, this.p, this.q, 1.6 * this.unit);
  }
}

/** Small weights stay visible. */
function opacity(weight: number): number {
  return 0.12 + 0.8 * Math.sqrt(weight);
}
