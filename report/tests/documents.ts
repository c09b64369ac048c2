// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Small documents for tests.
import type { JsonObject } from "../src/payload.ts";

const diagonal = (values: number[]) => values.map((value, i) => values.map((_, j) => (i === j ? value : 0)));

/** A detector that turns a mug by 180 degrees at times; body axes, degrees and millimetres. */
export const mug = {
  schema: 1, type: "posemix.mixture", group: "SE3", distribution: "concentrated", side: "right", order: "rotation_translation",
  units: { rotation: "deg", translation: "mm" },
  frames: { from: "camera", to: "mug" },
  components: [
    { weight: 0.7, mean: { translation: [0, 0, 800], quaternion_xyzw: [0, 0, 0, 1] }, covariance: diagonal([9, 9, 9, 16, 16, 64]) },
    { weight: 0.3, mean: { translation: [0, 0, 800], quaternion_xyzw: [0, 0, 1, 0] }, covariance: diagonal([9, 9, 9, 16, 16, 64]) },
  ],
};

/** Projected components with a standard deviation of u. */
export function projected(sd: number, quaternions = [[0, 0, 0, 1]]): JsonObject {
  return {
    schema: 1, type: "posemix.mixture", group: "SE3", distribution: "projected", side: "right", order: "rotation_translation",
    units: { rotation: "tan_half_angle", translation: "m" },
    frames: { from: "camera", to: "box" },
    components: quaternions.map((quaternion_xyzw, i) => ({
      log_weight: Math.log(1 / quaternions.length), tangent_point: { quaternion_xyzw },
      tangent_mean: { u: [0, 0, 0], translation: [0.01 * i, 0, 0.6] },
      covariance: diagonal([sd * sd, sd * sd, sd * sd, 1e-5, 1e-5, 4e-5]),
    })),
  };
}

const picture = (text: string) =>
  `<svg xmlns="http://www.w3.org/2000/svg" width="320" height="200"><rect width="320" height="200" fill="#fff"/><text x="20" y="100">${text}</text></svg>`;

export function mixtureReport(): JsonObject {
  return {
    schema: 1, type: "posemix.report", kind: "mixture", title: "A mug", program: "posemix 0.1.0",
    documents: { "mug.json": mug, "box.json": projected(0.05, [[0, 0, 0, 1], [0, 0.1, 0, 0.995], [0.1, 0, 0, 0.995]]) },
    tables: {}, pictures: {}, texts: {},
  };
}

export function saltBoxReport(): JsonObject {
  const stage = (name: string, sd: number) => ({
    stage: name, components: 7, log_evidence: null, rotation_std_deg: sd, translation_std_m: 1e-3 * sd,
    rotation_std_x_deg: sd, rotation_std_y_deg: 0.9 * sd, rotation_std_z_deg: 0.4 * sd,
    translation_std_x_m: 1e-3 * sd, translation_std_y_m: 1.1e-3 * sd, translation_std_z_m: 2e-3 * sd,
  });
  return {
    schema: 1, type: "posemix.report", kind: "salt_box", title: "salt box", program: "posemix 0.1.0",
    documents: {
      "study.json": { schema: 1, study: "salt-box", rows: [stage("feature_B", 7), stage("object_B", 7), stage("fused_l", 4), stage("merged_l", 4)] },
      "posterior.json": projected(0.04, [[0, 0, 0, 1], [0, 0.1, 0, 0.995]]),
    },
    tables: { "trials.csv": "tilts,features,nees_per_dof\nindependent,1,0.99\nshared_view,3,1.08\n" },
    pictures: {
      "flags_merged_l.svg": picture("merged"), "flags_fused_l.svg": picture("fused"),
      "flags_features.svg": picture("features"), "flags_objects.svg": picture("objects"),
    },
    texts: {},
  };
}

export function studyReport(): JsonObject {
  const rows = ["riekf", "midway"].flatMap((method, k) =>
    [0, 1, 2, 3].map((exponent) => ({ method, noise_exponent: exponent, robot_rotation_rmse_deg: 0.851 + exponent - 0.1 * k, anees: 1.002 })),
  );
  return {
    schema: 1, type: "posemix.report", kind: "study", title: "Monte Carlo", program: "posemix 0.1.0",
    documents: { "study.json": { schema: 1, study: "monte-carlo", rows } },
    tables: { "timing.csv": "method,noise_exponent,median_ms_per_run\nriekf,0,0.2534\nmidway,0,1.5\n" },
    pictures: { "errors.svg": picture("errors") },
    texts: { "report.md": "# Figures\n" },
  };
}

export function consistencyReport(): JsonObject {
  const part = (dof: number, anees: number): JsonObject => ({
    dof, anees, interval: [0.9 * anees, 1.1 * anees], band: [0.95, 1.05], independent_band: [0.95, 1.05], effective_frames: 300,
    median: 0.9 * anees, worst: 18.8, worst_stamp_s: 1.6, frame_band: [0.21, 2.4], within_frame_band: 0.65,
    coverage: { shares: [0.01, 0.14, 0.43], nominal: [0.014, 0.323, 0.826] },
  });
  const axis = (name: string, rms: number): JsonObject => ({
    axis: name, mean_error: 0.001, rms_error: 0.05, rms_sd: 0.05 / rms, normalized_mean: 0.02, normalized_rms: rms,
    bias_significance: 0.4, coverage: { shares: [0.2, 0.5, 0.7], nominal: [0.683, 0.954, 0.997] },
  });
  const pose = {
    name: "pose", frames: 3, verdict: "overconfident",
    findings: ["overconfident: standard deviations are too small by a factor of 1.54", "most overconfident along rotation z"],
    pose: part(6, 2.38), rotation: part(3, 3.74), position: part(3, 1.02), axes: [axis("rotation z", 3.04), axis("position x", 1.01)],
  };
  const ball = { ...pose, name: "objects/ball/world", pose: part(3, 1.1), rotation: null, findings: ["consistent"] };
  return {
    schema: 1, type: "posemix.report", kind: "consistency", title: "a.tum against b.tum", program: "posemix 0.1.0",
    documents: { "consistency.json": { schema: 1, type: "posemix.consistency", title: "a.tum against b.tum", alignment: "first", axes: "body", poses: [pose, ball] } },
    tables: { "consistency.csv": "pose,stamp_s,nees_per_dof\npose,0,1.2\npose,1,0.7\nobjects/ball/world,0,1.5\n" },
    pictures: { "consistency.svg": picture("NEES") },
    texts: { "consistency.md": "a.tum against b.tum\n" },
  };
}
