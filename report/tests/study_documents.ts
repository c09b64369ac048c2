// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Small studies with the columns of the program's, for tests: units that must not share an axis, totals, many groups, many rows.
import type { JsonObject } from "../src/payload.ts";

const provenance = (study: string, settings: JsonObject): JsonObject => ({
  program: "posemix", version: "0.2.0", seed: 7, started: "2026-03-01T12:00:00Z", command: ["posemix", "study", study, "--out", "out dir/x"], settings,
  inputs: [{ path: "data/sha256sums", sha256: "cafe0123" }],
});

export const drawing = (title: string) =>
  `<svg xmlns="http://www.w3.org/2000/svg" width="480" height="280" viewBox="0 0 480 280"><rect width="480" height="280" fill="#fff"/><text x="20" y="30">${title}</text><text x="200" y="270">time [s]</text><text x="20" y="200">0.5</text><path d="M40 240L440 60" stroke="#296E79" fill="none"/></svg>`;

function study(name: string, rows: JsonObject[], more: JsonObject = {}, document: JsonObject = {}): JsonObject {
  return {
    schema: 1, type: "posemix.report", kind: "study", title: `Study ${name}`, program: "posemix 0.2.0",
    documents: { "study.json": { schema: 1, study: name, rows, provenance: provenance(name, { runs: 400, path: { turns: 1 } }), ...document } },
    tables: {}, pictures: {}, texts: {}, ...more,
  };
}

export function monteCarlo(): JsonObject {
  const base: Record<string, number> = { riekf: 1.05, midway: 1, tangent_of_larger: 1.0001, iterated: 0.999 };
  const anees: Record<string, number> = { riekf: 3.314, midway: 1.562, tangent_of_larger: 1.562, iterated: 1.002 };
  const rows = Object.keys(base).flatMap((method) => [0, 1, 2, 3, 4, 5].map((noise_exponent) => ({
    method, noise_exponent, robot_rotation_rmse_deg: (0.85 + 1.83 * noise_exponent) * base[method],
    robot_rotation_rmse_deg_standard_error: 0.012 + 0.013 * noise_exponent, anees: 1 + ((anees[method] - 1) * noise_exponent) / 5,
    anees_standard_error: 0.014, anees_band_low: 0.9, anees_band_high: 1.1, runs: 400,
  })));
  return study("monte-carlo", rows, { pictures: { "errors.svg": drawing("Errors by level of noise") }, tables: {
    "paired.csv": "method,against,noise_exponent,quantity,mean_difference,standard_error,p_value,runs\nmidway,iterated,5,anees,0.5,0.01,0,400\nmidway,iterated,5,robot_rotation_rmse_deg,0.01,0.012,0.4,400\n",
    "timing.csv": "method,noise_exponent,median_ms_per_run\nriekf,0,0.2534\nmidway,0,1.5\n",
  }, texts: { "report.md": "# Figures\n" } });
}

/** Rotations in degrees and translations in metres, with a row over all objects. */
export function noise(figures = 12): JsonObject {
  const objects = ["mug", "soup-can", "all"];
  const rows = ["dope", "cosypose"].flatMap((detector, d) => objects.flatMap((object, o) =>
    ["rotation_x", "rotation_y", "translation_x", "translation_z"].map((axis, a) => ({
      detector, object, truth: "annotated", symmetric: 0, recordings: 3, axis, unit: a < 2 ? "deg" : "m", count: 1000 + o,
      robust_sd: a < 2 ? 2 + d + o + a : 0.004 * (1 + d + o + a), kurtosis: a === 0 && o === 0 ? 9.5 : 3.1, dependent_frames: 10 + o,
    }))));
  const pictures = Object.fromEntries(Array.from({ length: figures }, (_, i) => [`noise_dope-object_${i}.svg`, drawing(`Residuals of dope for object ${i}`)]));
  return study("noise", rows, { pictures });
}

/** More methods than a chart has groups for, in recordings, with rows of means and a run to each row. */
export function ycbv(methods = 19): JsonObject {
  const names = Array.from({ length: methods }, (_, i) => `method_${String(i).padStart(2, "0")}`);
  const rows: JsonObject[] = names.flatMap((method, m) => ["0001", "0004", "0022"].map((sequence, s) => ({
    sequence, object: "003", detector: "DOPE", method, frames: 600, relative_rotation_rmse_deg: 5 + m + s, pixel_median: 10 + m + 2 * s,
    report: `runs/${sequence}_003_${method}/report.html`,
  })));
  for (const row of names) rows.push({ sequence: "mean", object: "all", detector: "DOPE", method: row, frames: null, relative_rotation_rmse_deg: 500, pixel_median: 500, report: null });
  const summary = names.map((method, m) => ({ detector: "DOPE", method, rows: 3, pixel_median: 12 + m }));
  return study("ycbv", rows, {}, { summary });
}

/** Rows over all of what others divide. */
export function grasp(): JsonObject {
  const methods = ["base_rate", "gaussian", "mixture", "region_at_true_error"];
  const value: Record<string, number> = { base_rate: 0.174, gaussian: 0.147, mixture: 0.12, region_at_true_error: 0.054 };
  const rows = methods.flatMap((method) => ["all", "scene", "block"].flatMap((split) => ["all", "ycbv/2", "ycbv/3"].flatMap((object) => ["all", "parallel", "underactuated"].map((gripper, g) => ({
    method, split, object, gripper, estimator: "all", region: "own", grasps: 6741 - g, successes: 4000, brier: value[method] + (split === "scene" ? 0.02 : 0) + (object === "ycbv/3" ? 0.03 : 0) + 0.005 * g,
  })))));
  return study("grasp", rows);
}

export function unknownStudy(): JsonObject {
  return study("of the moon", [{ crater: "Tycho", depth_m: 4800 }, { crater: "Kepler", depth_m: 2600 }]);
}
