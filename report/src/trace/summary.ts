// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What is in metrics.json of the whole run, in sentences.
import { median } from "../math/statistics.ts";
import { isObject, type Json, type JsonObject } from "../payload.ts";
import { fixed, plural, short, time } from "../ui/numbers.ts";
import type { Trace } from "./trace.ts";

const object = (value: Json | undefined): JsonObject => (isObject(value) ? value : {});
const number = (value: Json | undefined): number => (typeof value === "number" ? value : NaN);

export function durationSentence(trace: Trace): string {
  const { frames, seconds, objects } = trace;
  const length = seconds[frames - 1];
  const lasting = length > 0 ? ` in ${time(length)}, ${short((frames - 1) / length)} frames per second` : "";
  return `${plural(frames, "frame")}${lasting}; ${plural(objects.length, "object")}; filter ${trace.head.method}.`;
}

/** [mm, deg] */
interface Errors {
  position: number;
  rotation: number;
}
/** Smaller errors are those of rounding [mm, deg]. */
const LEAST_ERROR = 1e-3;

function rms(part: JsonObject): Errors {
  return { position: 1000 * number(part["position_rmse_m"]), rotation: number(part["rotation_rmse_deg"]) };
}

const both = ({ position, rotation }: Errors) => `${short(position)} mm and ${short(rotation)} deg`;

/** "3.2 times smaller", or larger, or as large. */
export function comparison(own: number, other: number): string {
  const ratio = other / own;
  if (!Number.isFinite(ratio) || ratio <= 0) return "not comparable";
  if (ratio > 1.05) return `${fixed(ratio, 1)} times smaller`;
  return ratio < 1 / 1.05 ? `${fixed(1 / ratio, 1)} times larger` : "as large";
}

/** "with the filter the position error is 4.3 times smaller, the rotation error 5.2 times smaller" */
function besideOdometry(camera: Errors, odometry: Errors): string {
  const [position, rotation] = [comparison(camera.position, odometry.position), comparison(camera.rotation, odometry.rotation)];
  const isWorse = (text: string) => text.endsWith("larger");
  if (!isWorse(position) && !isWorse(rotation)) return `with the filter the position error is ${position}, the rotation error ${rotation}`;
  const lead = isWorse(position) && isWorse(rotation) ? "the filter is worse than odometry alone" : `the filter is worse than odometry alone in ${isWorse(position) ? "position" : "rotation"}`;
  return `${lead}: its position error is ${position}, its rotation error ${rotation}`;
}

/** The camera's errors beside those of odometry alone; undefined without ground truth. */
export function cameraSentence(metrics: Json | undefined): string | undefined {
  const camera = rms(object(object(metrics)["camera"]));
  if (Number.isNaN(camera.position)) return undefined;
  const odometry = rms(object(object(metrics)["odometry"]));
  const text = `Camera: rms error ${both(camera)}`;
  // A camera that is given, or stands still, has odometry without errors: that is no merit of odometry.
  const isGiven = odometry.position < LEAST_ERROR && odometry.rotation < LEAST_ERROR;
  if (Number.isNaN(odometry.position) || isGiven) return `${text}.`;
  return `${text}. Odometry alone has ${both(odometry)}: ${besideOdometry(camera, odometry)}.`;
}

/** The objects as seen from the camera beside their detections, over the same frames; undefined without ground truth. */
export function detectorSentence(metrics: Json | undefined): string | undefined {
  const ratios: { id: string; position: number; rotation: number }[] = [];
  for (const [id, value] of Object.entries(object(object(metrics)["objects"]))) {
    const paired = object(object(value)["paired"]);
    const ratio = (key: string) => number(object(paired["detection"])[key]) / number(object(paired["estimate"])[key]);
    const [position, rotation] = [ratio("position_median_m"), ratio("rotation_median_deg")];
    if (position > 0 && Number.isFinite(position)) ratios.push({ id, position, rotation: rotation > 0 && Number.isFinite(rotation) ? rotation : 1 });
  }
  if (ratios.length === 0) return undefined;
  const worse = ratios.filter(({ position, rotation }) => position < 0.95 || rotation < 0.95).map(({ id }) => id);
  const middle = (of: "position" | "rotation") => comparison(1, median(ratios.map((ratio) => ratio[of])));
  const place = middle("position");
  return `Objects as seen from the camera, in the same frames: the median position error is ${place} ${place === "as large" ? "as" : "than"} that of the detector, `
    + `the rotation error ${middle("rotation")} (median over the objects).${worse.length > 0 ? ` Larger than the detector's in position or rotation: ${worse.join(", ")}.` : ""}`;
}
