// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// How sure the filter is, in space: ellipsoids of the position, cones of the rotation, samples and principal axes.
import { Color, Group } from "three";
import { coneMap, MOST_HALF_ANGLE } from "../math/cone.ts";
import { PoseSamples } from "../math/pose_samples.ts";
import { DEGREES, matrixOf, multiply, type Numbers, rotate } from "../math/rotation.ts";
import { CAMERA, type Entity } from "../state/run_state.ts";
import type { Estimate, Trace } from "../trace/trace.ts";
import { AXIS_COLOURS } from "../ui/palette.ts";
import { Batch } from "./batch.ts";
import type { Bodies } from "./bodies.ts";
import type { CameraPart } from "./camera_part.ts";
import { exaggerationOf } from "./exaggeration.ts";
import type { LabelLayer, LabelStyle } from "./labels.ts";
import type { Layers, UncertaintyLook } from "./layers.ts";
import { axesShape, ballShape, barShape, coneShape } from "./shapes.ts";
import { Spread } from "./spread.ts";
import { mmText } from "./units.ts";

const SAMPLES = 80;
/** Share of the length of an axis that the median object's 3 sigma should have. */
const VISIBLE = 0.25;
/** The largest of it in the run, in lengths of an axis. */
const MOST = 5;
/** Of more objects the cones would hide each other: only the selected one has them. */
const MOST_CONED = 6;
const EYE_STRENGTH = 0.55;
const SHELL_OPACITY = [0, 0.95, 0.7, 0.55];
const IDENTITY = new Float64Array([0, 0, 0, 1]);

export class UncertaintyPart {
  readonly node = new Group();
  readonly look: UncertaintyLook = { sigma: 3, factor: 0, frame: "world" };
  /** Of the selected object, if it has a covariance. */
  readonly selected = new Spread();
  hasSelected = false;
  /** Whether it is seen through the recording's camera, whose image should be visible behind it. */
  fromEye = false;
  private readonly spread = new Spread();
  private readonly shells: Batch;
  private readonly cones: Batch;
  private readonly bars: Batch;
  private readonly cloud = new Batch(axesShape(0.03), SAMPLES, { tintShare: 0.35, order: 1 });
  private readonly samples = new PoseSamples(SAMPLES);
  private readonly automatic = new Map<string, number>();
  private readonly axisColours = AXIS_COLOURS.map((colour) => new Color(colour));
  private readonly ink = new Color();
  /** Whether a cone of this frame would be wider than cones are drawn. */
  private isCapped = false;
  private words = "";
  private wordsOf = NaN;
  private readonly turn = new Float64Array(9);
  private readonly axis = new Float64Array(3);
  private readonly map = new Float64Array(9);
  private readonly t = new Float64Array(3);
  private readonly q = new Float64Array(4);
  private readonly sampleP = new Float64Array(3);
  private readonly sampleQ = new Float64Array(4);
  private readonly covariance = new Float64Array(9);
  private readonly turnSd = new Float64Array(3);
  private readonly tangentSd = new Float64Array(3);

  constructor(
    private readonly trace: Trace, private readonly layers: Layers, private readonly camera: CameraPart,
    private readonly bodies: Bodies, private readonly unit: number,
  ) {
    const count = trace.objects.length + 1;
    this.shells = new Batch(ballShape(), 3 * count, { glass: true, onTop: true });
    this.cones = new Batch(coneShape(), 3 * count, { glass: true, onTop: true });
    this.bars = new Batch(barShape(), 3, { onTop: true, order: 6 });
    for (const batch of [this.shells, this.cones, this.bars, this.cloud]) this.node.add(batch.mesh);
  }

  /** How many times larger than true it is drawn. */
  get factor(): number {
    if (this.look.factor > 0) return this.look.factor;
    const isRelative = this.look.frame === "camera";
    const key = isRelative ? "relative" : "world";
    let found = this.automatic.get(key);
    if (found === undefined) {
      const of = (index: number) => (isRelative ? this.trace.objects[index].relative : this.trace.objects[index].world);
      found = exaggerationOf(this.trace, of, VISIBLE * this.unit, MOST * this.unit);
      this.automatic.set(key, found);
    }
    return found;
  }

  /** What is drawn, in words. */
  describe(): string {
    const { layers, look } = this;
    // The text is made anew only where it changes.
    const key = Number(layers.ellipsoids) + 2 * Number(layers.cones) + 4 * Number(layers.samples) + 8 * Number(look.frame === "camera") +
      16 * look.sigma + 64 * this.factor + 65536 * Number(this.isCapped);
    if (key !== this.wordsOf) this.words = this.describeNow();
    this.wordsOf = key;
    return this.words;
  }

  private describeNow(): string {
    const { layers, look } = this;
    const drawn = [layers.ellipsoids && "ellipsoids", layers.cones && "cones of rotation"].filter(Boolean).join(" and ");
    if (drawn === "" && !layers.samples) return "";
    const sigma = look.sigma === 0 ? "1, 2, 3 sigma" : `${look.sigma} sigma`;
    const { factor } = this;
    const capped = layers.cones && this.isCapped ? `, cones at most ${(MOST_HALF_ANGLE * DEGREES).toFixed(0)} deg wide to each side` : "";
    const size = factor === 1 ? "true size" : `drawn ${factor} times larger`;
    const of = look.frame === "camera" ? ", relative to the camera" : "";
    return (drawn === "" ? `samples, ${size}` : `${drawn}: ${sigma}, ${size}`) + capped + of;
  }

  begin(): void {
    this.hasSelected = false;
    this.isCapped = false;
    for (const batch of [this.shells, this.cones, this.bars, this.cloud]) batch.begin();
  }

  end(): void {
    for (const batch of [this.shells, this.cones, this.bars, this.cloud]) batch.end();
  }

  private estimateOf(entity: Entity): Estimate | undefined {
    const isRelative = this.look.frame === "camera";
    if (entity === CAMERA) return isRelative ? undefined : this.trace.camera;
    return isRelative ? this.trace.objects[entity].relative : this.trace.objects[entity].world;
  }

  /** Reads the uncertainty of what is at a pose in the world. */
  read(entity: Entity, frame: number, q: Numbers, into: Spread): boolean {
    const estimate = this.estimateOf(entity);
    const { frame: which } = this.look;
    if (!estimate || (which === "camera" && !this.camera.here)) return false;
    return into.read(estimate, frame, which, which === "camera" ? this.camera.quaternion : IDENTITY, q);
  }

  add(entity: Entity, frame: number, p: Numbers, q: Numbers, colour: Color, isSelected: boolean): void {
    const spread = isSelected ? this.selected : this.spread;
    if (!this.read(entity, frame, q, spread)) return;
    const { factor } = this;
    if (isSelected) this.hasSelected = true;
    if (this.layers.ellipsoids) this.addShells(spread, p, factor, colour);
    const isConed = entity !== CAMERA && (isSelected || this.trace.objects.length <= MOST_CONED);
    if (this.layers.cones && isConed) this.addCones(spread, p, q, factor, isSelected);
    if (!isSelected || entity === CAMERA) return;
    if (this.layers.lengths) this.addBars(spread, p, factor);
    if (this.layers.samples) this.addSamples(entity, frame, factor, colour);
  }

  private addShells(spread: Spread, p: Numbers, factor: number, colour: Color): void {
    for (let i = 0; i < 9; ++i) this.map[i] = spread.directions[i] * Math.max(1e-6, spread.lengths[i % 3]);
    const { sigma } = this.look;
    const strength = this.fromEye ? EYE_STRENGTH : 1;
    for (let times = 3; times >= 1; --times) {
      if (sigma === 0 || sigma === times) this.shells.addLinear(p, this.map, times * factor, colour, strength * SHELL_OPACITY[sigma === 0 ? times : 1]);
    }
  }

  private get times(): number {
    return this.look.sigma === 0 ? 3 : this.look.sigma;
  }

  private addCones(spread: Spread, p: Numbers, q: Numbers, factor: number, isSelected: boolean): void {
    matrixOf(q, this.turn);
    for (let k = 0; k < 3; ++k) {
      for (let i = 0; i < 3; ++i) this.axis[i] = this.turn[3 * i + k];
      this.isCapped = coneMap(this.axis, spread.rotation, this.times * factor, this.unit, this.map) || this.isCapped;
      this.cones.addLinear(p, this.map, 1, this.axisColours[k], isSelected ? 0.75 : 0.4);
    }
  }

  /** Along the principal axes; in the object's frame, along the object's own axes. */
  private addBars(spread: Spread, p: Numbers, factor: number): void {
    const isOwn = this.look.frame === "object";
    const columns = isOwn ? spread.axes : spread.directions;
    const thin = 0.012 * this.unit;
    for (let k = 0; k < 3; ++k) {
      const length = this.times * factor * (isOwn ? spread.alongSd[k] : spread.lengths[k]);
      for (let i = 0; i < 3; ++i) {
        this.map[3 * i] = thin * columns[3 * i + ((k + 1) % 3)];
        this.map[3 * i + 1] = thin * columns[3 * i + ((k + 2) % 3)];
        this.map[3 * i + 2] = length * columns[3 * i + k];
      }
      this.bars.addLinear(p, this.map, 1, isOwn ? this.axisColours[k] : this.ink, 1);
    }
  }

  setInk(ink: Color): void {
    this.ink.copy(ink);
  }

  /** The lengths of the selected object's axes, true ones, in mm. */
  addLengths(labels: LabelLayer, p: Numbers, style: LabelStyle): void {
    if (!this.hasSelected || !this.layers.lengths) return;
    const isOwn = this.look.frame === "object";
    const columns = isOwn ? this.selected.axes : this.selected.directions;
    const { factor } = this;
    for (let k = 0; k < 3; ++k) {
      const sd = this.times * (isOwn ? this.selected.alongSd[k] : this.selected.lengths[k]);
      const at = factor * sd;
      const text = `${isOwn ? `${"xyz"[k]} ` : ""}${mmText(sd)} mm`;
      labels.add(p[0] + at * columns[k], p[1] + at * columns[3 + k], p[2] + at * columns[6 + k], text, style);
    }
  }

  /** Poses of the Gaussian in its own frame, then placed in the world. */
  private addSamples(entity: Entity, frame: number, factor: number, colour: Color): void {
    const estimate = this.estimateOf(entity)!;
    if (!estimate.hasSd) return;
    estimate.pose.position(frame, this.t);
    estimate.pose.quaternion(frame, this.q);
    estimate.covariance(frame, this.covariance);
    estimate.rotationSd(frame, this.turnSd);
    estimate.tangentSd(frame, this.tangentSd);
    this.samples.prepare(this.t, this.covariance, this.turnSd, this.tangentSd);
    const isRelative = this.look.frame === "camera";
    for (let i = 0; i < this.samples.count; ++i) {
      this.samples.draw(i, this.t, this.q, factor, this.sampleP, this.sampleQ);
      if (isRelative) {
        rotate(this.camera.quaternion, this.sampleP, this.sampleP);
        for (let k = 0; k < 3; ++k) this.sampleP[k] += this.camera.position[k];
        multiply(this.camera.quaternion, this.sampleQ, this.sampleQ);
      }
      this.cloud.addPose(this.sampleP, this.sampleQ, 0.55 * this.unit, colour, 0.3);
      this.bodies.addSample(entity, this.sampleP, this.sampleQ);
    }
  }

  /** How far from the object's position its ellipsoid is drawn. */
  reach(entity: Entity, frame: number): number {
    if (!this.layers.ellipsoids || !this.read(entity, frame, IDENTITY, this.spread)) return 0;
    return this.times * this.factor * this.spread.lengths[0];
  }

  get counts(): { shells: number; cones: number; bars: number; samples: number } {
    return { shells: this.shells.mesh.count, cones: this.cones.mesh.count, bars: this.bars.mesh.count, samples: this.cloud.mesh.count };
  }
}
