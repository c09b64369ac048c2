// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { Box3, Color, type GridHelper, Quaternion, Vector3 } from "three";
import { cholesky } from "../math/linear.ts";
import { type Mixture, positionCovariance, rotationSd } from "../mixture/mixture.ts";
import type { Samples } from "../mixture/sample.ts";
import { componentColours } from "../mixture/order.ts";
import { Batch } from "./batch.ts";
import { axesShape, ballShape, flagShape, grid, gridStep } from "./shapes.ts";
import { degText, mmText } from "./units.ts";
import { type View, Viewport } from "./viewport.ts";

const LEAST_LABELLED = 0.02;
/** Many flags lie over each other: the fewer there are of a colour, the less each one hides. */
const FLAG_OPACITY = 0.16;
/** Share of the extent; the samples must remain visible between the poles. */
const FLAG_SIZE = 0.13;

export interface FlagLayers {
  flags: boolean;
  ellipsoids: boolean;
  means: boolean;
  labels: boolean;
}

/** A mixture in space: samples as flags, the components' means as axes and their positions as ellipsoids. */
export class FlagScene {
  readonly viewport: Viewport;
  readonly layers: FlagLayers = { flags: true, ellipsoids: false, means: true, labels: true };
  /** The step of the grid [m]. */
  step = 0;
  private readonly flags: Batch;
  private readonly glass: Batch;
  private readonly means: Batch;
  private size = 1;
  private ground: GridHelper | undefined;
  private mixture: Mixture | undefined;
  private samples: Samples | undefined;
  private hidden: ReadonlySet<number> = new Set();

  /** @param components, flags the largest numbers to be shown */
  constructor(name: string, components: number, flags: number) {
    this.viewport = new Viewport(name, new Vector3(0, 0, 1));
    this.flags = new Batch(flagShape(), flags);
    this.glass = new Batch(ballShape(), components, { glass: true, onTop: true });
    this.means = new Batch(axesShape(0.05), components, { solid: true });
    for (const batch of [this.flags, this.glass, this.means]) this.viewport.scene.add(batch.mesh);
    this.viewport.listen({ click: () => {}, doubleClick: (x, y) => this.centre(x, y), hover: (x, y) => this.tip(x, y) });
    this.viewport.onAxis = (view) => this.look(view);
  }

  private centre(x: number, y: number): void {
    const k = this.viewport.labels.at(x, y);
    if (k !== undefined && this.mixture) this.viewport.centreOn(new Vector3().fromArray(this.mixture.components[k].translation));
  }

  private tip(x: number, y: number): string[] {
    const k = this.viewport.labels.at(x, y);
    if (k === undefined || !this.mixture) return [];
    const component = this.mixture.components[k];
    const covariance = positionCovariance(this.mixture, component);
    return [
      `component ${k + 1}: ${(100 * component.weight).toFixed(2)} %`,
      `sigma of the position x y z ${[0, 4, 8].map((i) => mmText(Math.sqrt(covariance[i]))).join(", ")} mm`,
      `sigma of the rotation x y z ${rotationSd(this.mixture, component).map(degText).join(", ")} deg`,
    ];
  }

  /** Moves the view so that these mixtures are visible, with flags and ellipsoids. */
  fit(all: readonly { mixture: Mixture; flags: Samples }[]): void {
    const frame = all[0].mixture.from;
    // In camera frames y points down; in other frames z is assumed to point up.
    const up = frame === "camera" ? new Vector3(0, -1, 0) : new Vector3(0, 0, 1);
    const points = all.flatMap(({ mixture, flags }) => [...pointsOf(flags), ...ellipsoidPoints(mixture)]);
    const spread = new Box3().setFromPoints(points);
    const extent = Math.max(spread.min.distanceTo(spread.max), 1e-3);
    this.size = FLAG_SIZE * extent;
    this.viewport.setUp(up);
    this.viewport.setBounds([...points, ...all.flatMap(({ flags }) => topsOf(flags, this.size))]);
    const lowest = Math.min(spread.min.dot(up), spread.max.dot(up)) - this.size;
    this.ground?.removeFromParent();
    this.ground?.dispose();
    this.step = gridStep(extent);
    this.ground = grid(this.viewport.centre, up, extent, lowest);
    this.viewport.scene.add(this.ground);
    this.viewport.look("fit");
  }

  show(mixture: Mixture, samples: Samples, hidden: ReadonlySet<number>): void {
    this.mixture = mixture;
    this.samples = samples;
    this.hidden = hidden;
    this.update();
  }

  setLayer(layer: keyof FlagLayers, on: boolean): void {
    this.layers[layer] = on;
    this.update();
  }

  look(view: View): void {
    this.viewport.look(view);
    this.note();
  }

  private note(): void {
    const { caption } = this.viewport;
    this.viewport.overlay.notes = [...(this.layers.ellipsoids ? ["ellipsoids: 3 sigma, true size"] : []), ...(caption ? [caption] : [])];
  }

  /** Where the feet and tops of the shown flags are in the picture, for tests. */
  topPixels(): [number, number][] {
    const { camera, node } = this.viewport;
    camera.updateMatrixWorld();
    return this.samples ? [...pointsOf(this.samples), ...topsOf(this.samples, this.size)].map((point) => {
      point.project(camera);
      return [(0.5 + 0.5 * point.x) * node.clientWidth, (0.5 - 0.5 * point.y) * node.clientHeight];
    }) : [];
  }

  get flagCount(): number {
    return this.flags.mesh.count;
  }

  private update(): void {
    if (!this.mixture || !this.samples) return;
    const texts = componentColours(this.mixture);
    const colours = texts.map((text) => new Color(text));
    for (const batch of [this.flags, this.glass, this.means]) batch.begin();
    if (this.layers.flags) this.addFlags(this.samples, colours);
    this.viewport.labels.clear();
    this.mixture.components.forEach((component, k) => {
      if (this.hidden.has(k)) return;
      const opacity = 0.25 + 0.75 * Math.sqrt(component.weight);
      if (this.layers.means) this.means.addPose(component.translation, component.quaternion, 1.1 * this.size * Math.cbrt(component.weight), colours[k], 1);
      if (this.layers.ellipsoids) {
        const root = new Float64Array(9);
        const covariance = positionCovariance(this.mixture!, component);
        for (let i = 0; i < 3; ++i) covariance[4 * i] += 1e-12;
        cholesky(covariance, 3, root);
        this.glass.addLinear(component.translation, root, 3, colours[k], 0.6 * opacity);
      }
      if (this.layers.labels && component.weight >= LEAST_LABELLED) {
        const [x, y, z] = component.translation;
        this.viewport.labels.add(x, y, z, `${k + 1}: ${(100 * component.weight).toFixed(0)} %`, { colour: texts[k], entity: k, isName: true });
      }
    });
    for (const batch of [this.flags, this.glass, this.means]) batch.end();
    this.note();
    this.viewport.invalidate();
  }

  private addFlags(samples: Samples, colours: Color[]): void {
    for (let i = 0; i < samples.count; ++i) {
      const k = samples.components[i];
      if (this.hidden.has(k)) continue;
      const position = samples.positions.subarray(3 * i, 3 * i + 3);
      const quaternion = samples.quaternions.subarray(4 * i, 4 * i + 4);
      this.flags.addPose(position, quaternion, this.size, colours[k], FLAG_OPACITY);
    }
  }
}

function pointsOf({ positions, count }: Samples): Vector3[] {
  return Array.from({ length: count }, (_, i) => new Vector3().fromArray(positions, 3 * i));
}

/** The tops of the flags. */
function topsOf({ positions, quaternions, count }: Samples, height: number): Vector3[] {
  return Array.from({ length: count }, (_, i) =>
    new Vector3(0, 0, height).applyQuaternion(new Quaternion().fromArray(quaternions, 4 * i)).add(new Vector3().fromArray(positions, 3 * i)));
}

/** The corners of the boxes around the 3-sigma ellipsoids. */
function ellipsoidPoints(mixture: Mixture): Vector3[] {
  return mixture.components.filter(({ weight }) => weight > 1e-3).flatMap((component) => {
    const covariance = positionCovariance(mixture, component);
    const reach = new Vector3(...[0, 4, 8].map((i) => 3 * Math.sqrt(covariance[i])));
    const centre = new Vector3().fromArray(component.translation);
    return [0, 1, 2].flatMap((axis) => [1, -1].map((sign) => centre.clone().setComponent(axis, centre.getComponent(axis) + sign * reach.getComponent(axis))));
  });
}
