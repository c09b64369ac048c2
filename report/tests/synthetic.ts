// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A run that no filter made, of any size: a camera that goes round objects, each with hypotheses.
import { normal, uniform } from "../src/mixture/sample.ts";
import type { ColumnHead, JsonObject, PackedTrace } from "../src/payload.ts";
import { TraceWriter } from "./encode.ts";
import { STATUSES } from "./pack.ts";

export interface Size {
  frames: number;
  objects: number;
  hypotheses: number;
}

const GHOST_PLACE = 1e-4;
const GHOST_TURN = 1 / 8191;
const SD = 5e-3;

/** Rows of floats, one array per component. */
type Parts = Float64Array[];

class Generator {
  private readonly writer: TraceWriter;
  private readonly gauss = normal(uniform(7));

  constructor(private readonly size: Size) {
    this.writer = new TraceWriter(size.frames);
  }

  private parts(width: number): Parts {
    return Array.from({ length: width }, () => new Float64Array(this.size.frames));
  }

  private add(name: string, type: ColumnHead["type"], scale: number, parts: Parts, map: ColumnHead["map"] = "linear"): void {
    const components = parts.map((values) => {
      const integers = new Int32Array(values.length);
      for (let i = 0; i < values.length; ++i) integers[i] = Math.round((map === "exp" ? Math.log(values[i]) : values[i]) / scale);
      return integers;
    });
    this.writer.add({ name, width: parts.length, type, scale, map }, components);
  }

  private constant(name: string, type: ColumnHead["type"], scale: number, value: number): void {
    this.add(name, type, scale, [new Float64Array(this.size.frames).fill(value)]);
  }

  private poses(name: string, poses: Parts, place = 1e-5, turn = 1 / 32767): void {
    this.add(`${name}/position`, "int32", place, poses.slice(0, 3));
    this.add(`${name}/quaternion`, "int16", turn, poses.slice(3));
  }

  /** Standard deviations that fall from `start` to a floor, and correlations. */
  private spread(name: string, start: number): void {
    const falling = (first: number) => Float64Array.from({ length: this.size.frames }, (_, i) => first * (0.1 + 0.9 / Math.sqrt(1 + i)));
    this.add(`${name}/log_sd`, "int16", SD, [1, 1.2, 0.8, 0.1, 0.1, 0.15].map((share) => falling(share * start)), "exp");
    this.add(`${name}/position_log_sd`, "int16", SD, [0.12, 0.1, 0.2].map((share) => falling(share * start)), "exp");
    this.add(`${name}/position_correlation`, "int16", 1 / 32767, [0.5, -0.3, 0.2].map((rho) => new Float64Array(this.size.frames).fill(rho)));
  }

  /** A pose that stays, shaken; the shaking falls off, as that of a filter's estimate. */
  private shaken(mean: number[], place: number, turn: number, floor: number): Parts {
    const parts = this.parts(7);
    const at = [...mean];
    for (let i = 0; i < this.size.frames; ++i) {
      const share = floor + (1 - floor) / (1 + i);
      for (let k = 0; k < 3; ++k) at[k] += 0.05 * (mean[k] - at[k]) + place * share * this.gauss();
      for (let k = 3; k < 7; ++k) at[k] += 0.05 * (mean[k] - at[k]) + turn * share * this.gauss();
      const norm = Math.hypot(at[3], at[4], at[5], at[6]);
      for (let k = 0; k < 7; ++k) parts[k][i] = k < 3 ? at[k] : at[k] / norm;
    }
    return parts;
  }

  private noisy(truth: Parts, place: number, turn: number): Parts {
    const parts = truth.map((values, k) => Float64Array.from(values, (value) => value + (k < 3 ? place : turn) * this.gauss()));
    for (let i = 0; i < this.size.frames; ++i) {
      const norm = Math.hypot(parts[3][i], parts[4][i], parts[5][i], parts[6][i]);
      for (let k = 3; k < 7; ++k) parts[k][i] /= norm;
    }
    return parts;
  }

  /** A circle at two metres around the origin, looking in. */
  private circle(): Parts {
    const parts = this.parts(7);
    for (let i = 0; i < this.size.frames; ++i) {
      const angle = (2 * Math.PI * 3 * i) / this.size.frames;
      const half = angle / 2 - Math.PI / 4;
      parts[0][i] = 2 * Math.cos(angle);
      parts[1][i] = 2 * Math.sin(angle);
      parts[2][i] = 0.8;
      // Rz(angle - 90 deg) after the turn that takes the camera's z to -y and its y to -z of the world.
      const [c, s] = [Math.cos(half), Math.sin(half)];
      const [x, y, z, w] = [0, Math.SQRT1_2, -Math.SQRT1_2, 0];
      [parts[3][i], parts[4][i], parts[5][i], parts[6][i]] = [c * x - s * y, c * y + s * x, c * z + s * w, c * w - s * z];
    }
    return parts;
  }

  private object(index: number): void {
    const { frames, objects, hypotheses } = this.size;
    const name = `objects/object-${index}`;
    const angle = (2 * Math.PI * index) / objects;
    const place = [0.5 * Math.cos(angle), 0.5 * Math.sin(angle), 0.05 * (index % 3)];
    const mean = [...place, 0, 0, Math.sin(angle / 2), Math.cos(angle / 2)];
    const still = this.parts(7).map((values, k) => values.fill(mean[k]));
    this.constant(`${name}/mask`, "uint8", 1, 0b111111);
    const leading = this.shaken(mean, 5e-3, 0.01, 0.005);
    this.poses(`${name}/world`, leading);
    this.spread(`${name}/world`, 0.3);
    this.poses(`${name}/world/truth`, still);
    const relative = this.shaken([0.1, 0.05 * index, 1.6, 0.5, 0.5, 0.5, 0.5], 0.01, 0.01, 0.02);
    this.poses(`${name}/relative/truth`, relative);
    this.poses(`${name}/relative`, this.noisy(relative, 2e-4, 5e-4));
    this.spread(`${name}/relative`, 0.3);
    this.poses(`${name}/detection`, this.noisy(relative, 2e-3, 5e-3), 1e-4, GHOST_TURN);
    this.add(`${name}/status`, "uint8", 1, [Float64Array.from({ length: frames }, (_, i) => (i === 0 ? 1 : i % 97 < 3 ? 5 : i % 131 < 9 ? 0 : 2))]);
    const heaviest = Float64Array.from({ length: frames }, (_, i) => 1 - 0.5 / (1 + i / 200));
    this.add(`${name}/mode_probability`, "uint16", 1 / 65535, [heaviest]);
    for (let k = 0; k < hypotheses; ++k) {
      const slot = `${name}/hypotheses/${k}`;
      const turn = (Math.PI * k) / hypotheses;
      const [c, s] = [Math.cos(angle / 2 + turn), Math.sin(angle / 2 + turn)];
      const near = [place[0] + 0.01 * k, place[1], place[2], 0, 0, s, c];
      const share = k === 0 ? 0 : 2 ** -k / (1 - 2 ** -(hypotheses - 1));
      this.constant(`${slot}/mask`, "uint8", 1, 1);
      this.constant(`${slot}/id`, "int32", 1, 100 * index + k);
      const weights = heaviest.map((value) => (k === 0 ? value : share * (1 - value)));
      this.add(`${slot}/probability`, "uint16", 1 / 65535, [weights]);
      this.poses(slot, k === 0 ? leading : this.shaken(near, 5e-3, 0.01, 0.005), GHOST_PLACE, GHOST_TURN);
    }
  }

  packed(): PackedTrace {
    const { frames, objects } = this.size;
    const truth = this.circle();
    this.constant("camera/mask", "uint8", 1, 3);
    this.poses("camera/truth", truth);
    this.poses("camera", this.noisy(truth, 1e-3, 5e-4));
    this.spread("camera", 0.2);
    for (let index = 0; index < objects; ++index) this.object(index);
    return this.writer.packed({
      name: "synthetic",
      method: "multi-object",
      order: Array.from({ length: objects }, (_, i) => `object-${i}`),
      stamps_s: Array.from({ length: frames }, (_, i) => 100 + i / 30),
      statuses: STATUSES,
    });
  }
}

export function syntheticTrace(size: Size): PackedTrace {
  return new Generator(size).packed();
}

/** A metrics.json of the same objects. */
export function syntheticMetrics({ frames, objects }: Size): JsonObject {
  const own = (i: number) => ({
    position_rmse_m: 0.002612552545729 + 1e-4 * i, rotation_rmse_deg: 1.7357129823172 + 0.1 * i,
    detections: frames - i, gated: i, right_mode_share: 1, mode_probability: null,
  });
  const ids = Array.from({ length: objects }, (_, i) => `object-${i}`);
  return {
    schema: 1, frames, method: "multi-object",
    camera: { position_rmse_m: 0.01588227651614451, rotation_rmse_deg: 1.7583930057088142, position_log_rmse_m: 5.778e-5 },
    odometry: { position_rmse_m: null, rotation_rmse_deg: null },
    objects: Object.fromEntries(ids.map((id, i) => [id, own(i)])),
    consistency: { relative_anees: Object.fromEntries(ids.map((id, i) => [id, 1.5 + 0.01 * i])) },
    timing: { frame_median_us: 47.27, merges_per_frame: 0.006081668114682885 },
  };
}

export function syntheticReport(size: Size, more: JsonObject = {}): JsonObject {
  return {
    schema: 1, type: "posemix.report", kind: "slam", title: "synthetic", program: "posemix 0.1.0",
    documents: { "metrics.json": syntheticMetrics(size) }, tables: {}, pictures: {}, texts: {},
    trace: syntheticTrace(size) as unknown as JsonObject, ...more,
  };
}
