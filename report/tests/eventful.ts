// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A run in which every object has a trouble of its own, at frames that tests know.
import { multiply, multiplyInverse, quaternionOf, rotate } from "../src/math/rotation.ts";
import { normal, uniform } from "../src/mixture/sample.ts";
import type { JsonObject } from "../src/payload.ts";
import { packTrace, type TraceJson } from "./pack.ts";

export const FRAMES = 300;
export const STEP_S = 0.1;
/** What happens at which frame. */
export const AT = {
  flip: 60, pruned: 120, unexplained: [140, 151], dragged: [145, 169], enters: 30, lost: [200, 239], again: [220, 239], moves: [90, 149],
} as const;
export const IDS = ["mug", "tea-box", "cracker-box", "late-cup", "cart"] as const;
/** Standard deviations of the estimates: rotation [rad], position [m]. */
export const SD = [0.01, 0.01, 0.015, 0.002, 0.002, 0.004];

type Pose = number[];
const frames = <T>(make: (frame: number) => T) => Array.from({ length: FRAMES }, (_, frame) => make(frame));
const within = (frame: number, [from, to]: readonly [number, number]) => frame >= from && frame <= to;
const turnZ = (angle: number) => [0, 0, Math.sin(angle / 2), Math.cos(angle / 2)];

/** A^-1 B. */
function between(a: Pose, b: Pose): Pose {
  const inverse = [-a[3], -a[4], -a[5], a[6]];
  const p = [0, 1, 2].map((i) => b[i] - a[i]);
  const q = [0, 0, 0, 1];
  rotate(inverse, p, p);
  multiply(inverse, b.slice(3), q);
  return [...p, ...q];
}

/** exp(e) on the left of the rotation, and added to the position. */
function shifted(pose: Pose, e: number[]): Pose {
  const [turn, q] = [[0, 0, 0, 1], [0, 0, 0, 1]];
  quaternionOf(e, turn);
  multiply(turn, pose.slice(3), q);
  return [0, 1, 2].map((i) => pose[i] + e[i + 3]).concat(q);
}

const squareOf = (e: number[]) => e.reduce((sum, value, i) => sum + (value / SD[i]) ** 2, 0);

interface Options {
  truth?: boolean;
  nees?: boolean;
}

class Maker {
  private readonly gauss = normal(uniform(11));
  private readonly camera = frames((k) => {
    const angle = 0.6 * Math.sin(k / 60);
    return [Math.sin(angle), -Math.cos(angle), 0.5, ...lookAt(angle)];
  });

  constructor(private readonly options: Required<Options>) {}

  private error(): number[] {
    return SD.map((sd) => sd * this.gauss());
  }

  private track(truth: Pose[], errors: number[][], here: (frame: number) => boolean) {
    const only = <T>(value: (frame: number) => T) => frames((k) => (here(k) ? value(k) : null));
    const { options } = this;
    return {
      pose: only((k) => shifted(truth[k], errors[k])), sd: only(() => SD),
      position_covariance: only(() => [SD[3] ** 2, 0, 0, SD[4] ** 2, 0, SD[5] ** 2]),
      truth: options.truth ? truth : null,
      ...(options.truth && options.nees ? { nees: only((k) => squareOf(errors[k])) } : {}),
    };
  }

  private object(id: string) {
    const index = IDS.indexOf(id as (typeof IDS)[number]);
    const here = (k: number) => id !== "late-cup" || k >= AT.enters;
    const moved = (k: number) => (id === "cart" ? Math.max(0, Math.min(1, (k - AT.moves[0]) / (AT.moves[1] - AT.moves[0]))) : 0);
    const truth = frames((k) => [0.25 * Math.cos(1.3 * index) + 0.3 * moved(k), 0.25 * Math.sin(1.3 * index), 0.05, ...turnZ(0.7 * index)]);
    const wrong = frames((k) => [0, 0, id === "tea-box" && k < AT.flip ? Math.PI : 0, id === "cracker-box" && within(k, AT.dragged) ? 8 * SD[3] : 0, 0, 0]);
    const noisy = (error: number[]) => this.error().map((value, i) => value + error[i]);
    const world = this.track(truth, wrong.map(noisy), here);
    const seen = truth.map((pose, k) => between(this.camera[k], pose));
    const relative = this.track(seen, wrong.map((error, k) => noisy(this.asSeen(error, k))), here);
    const status = frames((k) => {
      if (!here(k) || (id === "late-cup" && within(k, AT.lost))) return "none";
      if (k === 0 || (id === "late-cup" && k === AT.enters)) return "started";
      return id === "cracker-box" && within(k, AT.unexplained) ? "doubted" : "used";
    });
    return {
      world, relative, status,
      detection: frames((k) => (status[k] === "none" ? null : shifted(seen[k], this.error().map((value) => 2 * value)))),
      nis: frames((k) => (status[k] === "used" ? squareOf(this.error()) : null)),
      ...this.belief(id, here, world.pose as (Pose | null)[], truth),
      ...this.states(id, here),
    };
  }

  /** The error along the camera's axes. */
  private asSeen(e: number[], frame: number): number[] {
    const q = this.camera[frame].slice(3);
    const inverse = [-q[0], -q[1], -q[2], q[3]];
    const [turn, shift] = [e.slice(0, 3), e.slice(3)];
    rotate(inverse, turn, turn);
    rotate(inverse, shift, shift);
    return [...turn, ...shift];
  }

  private belief(id: string, here: (frame: number) => boolean, pose: (Pose | null)[], truth: Pose[]) {
    const two = (k: number) => id === "tea-box" && k < AT.pruned;
    const leading = (k: number) => (k < AT.flip ? 0.57 : 0.57 + (0.4 * (k - AT.flip)) / (AT.pruned - AT.flip));
    const alternatives = frames((k) => {
      if (!here(k)) return [];
      if (!two(k)) return [{ id: 10 + (id === "tea-box" ? 1 : 0), probability: 0.995, pose: pose[k]! }];
      // Hypothesis 10 is turned, 11 is right; the other one is the estimate's flip, 12 mm beside it.
      const isRight = k >= AT.flip;
      const other = shifted(truth[k], [0, 0, isRight ? Math.PI : 0, 0.012, 0, 0]);
      return [{ id: isRight ? 11 : 10, probability: leading(k), pose: pose[k]! }, { id: isRight ? 10 : 11, probability: 1 - leading(k), pose: other }];
    });
    return { alternatives, mode_probability: frames((k) => (here(k) ? (two(k) ? leading(k) : 0.998) : null)) };
  }

  private states(id: string, here: (frame: number) => boolean) {
    const lost = (k: number) => id === "late-cup" && within(k, AT.lost);
    const moves = frames((k) => (within(k, AT.moves) ? [0.04, 0.96] : [0.98, 0.02]));
    return {
      existence: frames((k) => (!here(k) ? null : lost(k) ? 0.4 : 0.998)),
      health: frames((k) => (!here(k) ? "none" : lost(k) ? "lost" : "good")),
      register_again: frames((k) => id === "late-cup" && within(k, AT.again)),
      ...(id === "cart" ? { model_names: ["static", "constant_velocity"], models: moves } : {}),
    };
  }

  trace(): TraceJson {
    return {
      name: "eventful", method: "multi-object", frames: FRAMES, stamps_s: frames((k) => 50 + STEP_S * k), order: [...IDS],
      camera: this.track(this.camera, frames(() => this.error()), () => true),
      objects: Object.fromEntries(IDS.map((id) => [id, this.object(id)])), hypotheses: frames(() => []),
    };
  }
}

/** A camera at (sin a, -cos a) that looks at the origin: z towards it and down, x to the right. */
function lookAt(angle: number): number[] {
  const [down, q, out] = [[0, 0, 0, 1], [0, 0, 0, 1], [0, 0, 0, 1]];
  quaternionOf([-Math.PI / 2 - 0.46, 0, 0], down);
  multiplyInverse(turnZ(angle), [0, 0, 0, 1], q);
  multiply(q, down, out);
  return out;
}

export function eventfulTrace({ truth = true, nees = true }: Options = {}): TraceJson {
  return new Maker({ truth, nees }).trace();
}

export function eventfulMetrics(): JsonObject {
  const own = (i: number): JsonObject => ({
    position_rmse_m: 0.00261255 * (1 + i), rotation_rmse_deg: 1.7357129 + 30 * (i === 1 ? 1 : 0),
    relative_position_rmse_m: 0.0031 + 1e-4 * i, relative_rotation_rmse_deg: 1.2, detection_relative_position_rmse_m: 0.0091, detection_relative_rotation_rmse_deg: 4.4,
    paired: { frames: 250, estimate: { position_median_m: 0.002 + 1e-4 * i, rotation_median_deg: 0.9 }, detection: { position_median_m: 0.006, rotation_median_deg: 2.7 } },
    detections: 290 - i, gated: i === 2 ? 12 : 0, right_mode_share: i === 1 ? 0.8 : 1, mode_probability: 0.998, existence: 0.998, health: "good",
    health_shares: { none: 0, good: 0.9, lost: i === 3 ? 0.1 : 0 },
  });
  const by = (make: (i: number) => JsonObject): JsonObject => Object.fromEntries(IDS.map((id, i) => [id, make(i)]));
  const numbers = (make: (i: number) => number): JsonObject => Object.fromEntries(IDS.map((id, i) => [id, make(i)]));
  return {
    schema: 1, frames: FRAMES, method: "multi-object",
    camera: { position_rmse_m: 0.00588, rotation_rmse_deg: 0.7583, position_log_rmse_m: 5.778e-3 },
    odometry: { position_rmse_m: 0.0451, rotation_rmse_deg: 2.3 },
    objects: by(own), consistency: { relative_anees: numbers((i) => 1 + 0.1 * i), right_mode_relative_anees: numbers(() => 1.02) },
    camera_consistency: { anees: 1.04, median_nees: 0.97, rotation_anees: 1.1, position_anees: null },
    relative_consistency: by((i) => ({ anees: 1 + i, median_nees: 0.9, rotation_anees: 1, position_anees: 1.1 })),
    timing: { frame_median_us: 47.27, update_median_us: 30.1, reduce_median_us: null, merges_per_frame: 0.006 },
  };
}

export function eventfulReport(options: Options = {}, more: JsonObject = {}): JsonObject {
  return {
    schema: 1, type: "posemix.report", kind: "slam", title: "eventful", program: "posemix", tables: {}, pictures: {}, texts: {}, meshes: {},
    documents: { "metrics.json": options.truth === false ? { schema: 1, frames: FRAMES, method: "multi-object" } : eventfulMetrics() },
    trace: packTrace(eventfulTrace(options)) as unknown as JsonObject, ...more,
  };
}
