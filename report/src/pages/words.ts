// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What the quantities of a run are called, in which unit they are shown, and what they mean.

export interface Word {
  name: string;
  /** The shown value is that of the file times `scale`. */
  unit?: string;
  scale?: number;
  text: string;
  /** Of words that need more than a line. */
  isLong?: boolean;
}

export const MODE_PROBABILITY =
  "The filter's own probability that the estimate is on the right mode, not on a flip of it. It is a belief: ground truth has no part in it.";

const mm = { unit: "mm", scale: 1000 } as const;
const deg = { unit: "deg" } as const;
const share = { unit: "%", scale: 100 } as const;
const us = { unit: "µs" } as const;

/** By the last key of the path in metrics.json. */
export const WORDS: Readonly<Record<string, Word>> = {
  frames: { name: "frames", text: "Number of frames that the numbers beside it are over." },
  method: { name: "filter", text: "The method that made the run." },
  position_rmse_m: { name: "position error, rms", ...mm, text: "Root mean square of the distance between estimate and ground truth, over the frames that have both." },
  rotation_rmse_deg: { name: "rotation error, rms", ...deg, text: "Root mean square of the angle between estimate and ground truth." },
  position_log_rmse_m: { name: "position error, logarithm, rms", ...mm, text: "The translation part of Log(T_est T_true^-1), as papers on this group report it. It depends on where the world's origin is." },
  relative_position_rmse_m: { name: "filter: position, rms", ...mm, text: "Position error of the object as seen from the camera (T_camera_object) as the filter has it, over all frames with an estimate." },
  relative_rotation_rmse_deg: { name: "filter: rotation, rms", ...deg, text: "Rotation error of the object as seen from the camera as the filter has it." },
  detection_relative_position_rmse_m: { name: "detector: position, rms", ...mm, text: "Position error of the detections alone, over the frames with a detection." },
  detection_relative_rotation_rmse_deg: { name: "detector: rotation, rms", ...deg, text: "Rotation error of the detections alone." },
  "paired/frames": { name: "frames", text: "Frames with an estimate, a detection and ground truth: filter and detector are compared over the same ones." },
  "paired/estimate/position_median_m": { name: "filter: position, median", ...mm, text: "Median error of the filter over these frames." },
  "paired/estimate/rotation_median_deg": { name: "filter: rotation, median", ...deg, text: "Median error of the filter over these frames." },
  "paired/detection/position_median_m": { name: "detector: position, median", ...mm, text: "Median error of the detector over these frames." },
  "paired/detection/rotation_median_deg": { name: "detector: rotation, median", ...deg, text: "Median error of the detector over these frames." },
  detections: { name: "detections", text: "Detections of this object, with those that were not explained." },
  unexplained: {
    name: "not explained",
    text: "Detections that the filter took for gross errors: those with the status doubted, birth or gated.",
  },
  gated: { name: "outside the gate", text: "Detections outside the gate of all hypotheses, which were not used: a part of those that were not explained." },
  right_mode_share: { name: "near the truth", ...share, text: "Share of the frames whose estimate, as seen from the camera, is within 20 deg and 10 cm of the ground truth." },
  mode_probability: { name: "mode probability", ...share, text: `${MODE_PROBABILITY} At the last frame.` },
  existence: { name: "exists", ...share, text: "Probability that the object exists, at the last frame." },
  health: { name: "track", text: "State of the track at the last frame: none (never seen), tentative (not confirmed), good, ambiguous (it may be on another mode), inconsistent (detections are not as the noise says), lost (it should be seen, and is not)." },
  relative_anees: { name: "NEES", text: "Mean normalised estimation error squared of T_camera_object per degree of freedom: 1 is consistent, larger is overconfident, smaller is cautious." },
  right_mode_relative_anees: { name: "NEES near the truth", text: "The same over the frames within 20 deg and 10 cm of the ground truth, so that flips do not count." },
  anees: { name: "NEES, mean", text: "Mean normalised estimation error squared per degree of freedom: 1 is consistent, larger is overconfident. A few frames on a wrong mode make it large." },
  median_nees: { name: "NEES, median", text: "Its median over the frames, which a few frames on a wrong mode do not change." },
  rotation_anees: { name: "NEES, rotation", text: "Of the rotation alone, at the body." },
  position_anees: { name: "NEES, position", text: "Of the position alone, at the body." },
  verdict: {
    name: "verdict",
    text: "Whether errors are as large as the covariances say, as posemix consistency finds it: consistent, overconfident (errors are larger) or cautious (smaller). Where standard deviations are less than 1.5 times too small, the cards say slightly overconfident.",
  },
  interval: { name: "NEES, 95 % interval", text: "Within it the mean NEES is, as far as so many independent frames can tell: above 1 throughout is overconfident, below 1 cautious." },
  effective_frames: { name: "independent frames", text: "Errors of frames that follow one another are alike: as many independent frames say as much." },
  reason: { name: "most at fault", isLong: true, text: "The part or the direction of the pose whose errors are the least as its covariance says." },
  frame_median_us: { name: "frame", ...us, text: "Median time of a frame: predict, update, reduce and summarise." },
  update_median_us: { name: "update", ...us, text: "Median time of the update." },
  reduce_median_us: { name: "reduction", ...us, text: "Median time in which hypotheses are pruned and merged." },
  merges_per_frame: { name: "merges per frame", text: "Pairs of hypotheses that were merged, per frame." },
};

/** What older files call it. */
const FORMER: Readonly<Record<string, string>> = { gated: "unexplained" };

/** Words of what became of detections, in metrics and plots. */
export const STATUS_WORDS: Readonly<Record<string, string>> = {
  none: "no detection of the object in this frame",
  started: "the object entered the map",
  used: "used in the update",
  doubted: "used, but under the leading hypothesis more likely a gross error than not",
  birth: "no hypothesis explains it, so it began a new one",
  gated: "outside the gate of all hypotheses, and not used",
  failed: "not used, for numerical reasons",
};

export const HELP_WORDS: Readonly<Record<string, string>> = {
  "3 sigma": "Three standard deviations of the filter's covariance, by axis: 99.7 % of the errors of a consistent filter are within.",
  hypothesis: "One of the poses at which an object may be, with its probability. What is left over is other, less probable poses, or that none of the detections was the object.",
  "leading hypothesis": "The one that is reported as the estimate.",
  mode: "A pose near which the estimate or a detector's answer may lie, such as the true pose and its flip.",
  "mode probability": MODE_PROBABILITY,
  innovation: "A detection minus what the filter expected; NIS is its squared Mahalanobis distance.",
  NEES: "Normalised estimation error squared: the squared error in units of the covariance. Per degree of freedom 1 is expected.",
  "not explained": "A detection that the leading hypothesis does not explain: its status is doubted, birth, gated or failed.",
};

/** The word of a path in metrics.json, by its end. `isOlder`: of a file that does not tell what was gated from all that was not explained. */
export function wordOf(path: string, isOlder = false): Word | undefined {
  const keys = path.split("/");
  for (let i = 0; i < keys.length; ++i) {
    const end = keys.slice(i).join("/");
    const own = isOlder && Object.hasOwn(FORMER, end) ? FORMER[end] : end;
    if (Object.hasOwn(WORDS, own)) return WORDS[own];
  }
  return undefined;
}
