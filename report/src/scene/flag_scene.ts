// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { Box3, Color, type GridHelper, Vector3 } from "three";
import { cholesky } from "../math/linear.ts";
import { type Mixture, positionCovariance } from "../mixture/mixture.ts";
import type { Samples } from "../mixture/sample.ts";
import { colourOf } from "../ui/palette.ts";
import { themeColour } from "../ui/theme.ts";
import { Batch } from "./batch.ts";
import { axesShape, ballShape, flagShape, grid } from "./shapes.ts";
import { Viewport } from "./viewport.ts";

const LEAST_LABELLED = 0.02;

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
    this.glass = new Batch(ballShape(), components, { glass: true });
    this.means = new Batch(axesShape(0.05), components, { solid: true });
    for (const batch of [this.flags, this.glass, this.means]) this.viewport.scene.add(batch.mesh);
  }

  /** Moves the view so that these samples are visible, in the frame of this name. */
  fit(frame: string, all: Samples[]): void {
    // In camera frames y points down; in other frames z is assumed to point up.
    const up = frame === "camera" ? new Vector3(0, -1, 0) : new Vector3(0, 0, 1);
    const points = all.flatMap(pointsOf);
    const spread = new Box3().setFromPoints(points);
    const extent = Math.max(spread.min.distanceTo(spread.max), 1e-3);
    this.size = 0.16 * extent;
    this.viewport.setUp(up);
    this.viewport.setBounds(points);
    const lowest = Math.min(spread.min.dot(up), spread.max.dot(up)) - this.size;
    this.ground?.removeFromParent();
    this.ground?.dispose();
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

  get flagCount(): number {
    return this.flags.mesh.count;
  }

  private update(): void {
    if (!this.mixture || !this.samples) return;
    const colours = this.mixture.components.map((_, k) => new Color(colourOf(k)));
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
        this.viewport.labels.add(x, y, z, `${k + 1}: ${(100 * component.weight).toFixed(0)} %`, themeColour("--ink"));
      }
    });
    for (const batch of [this.flags, this.glass, this.means]) batch.end();
    this.viewport.invalidate();
  }

  private addFlags(samples: Samples, colours: Color[]): void {
    for (let i = 0; i < samples.count; ++i) {
      const k = samples.components[i];
      if (this.hidden.has(k)) continue;
      const position = samples.positions.subarray(3 * i, 3 * i + 3);
      const quaternion = samples.quaternions.subarray(4 * i, 4 * i + 4);
      this.flags.addPose(position, quaternion, this.size, colours[k], 0.45);
    }
  }
}

function pointsOf({ positions, count }: Samples): Vector3[] {
  return Array.from({ length: count }, (_, i) => new Vector3().fromArray(positions, 3 * i));
}
