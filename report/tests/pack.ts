// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Packs a trace.json of `posemix slam`, for tests and looks at real runs.
import type { PackedTrace } from "../src/payload.ts";
import { TraceWriter } from "./encode.ts";

type Pose = number[];
type Poses = (Pose | null)[];

interface TrackJson {
  pose: Poses;
  sd: Poses;
  position_covariance?: Poses;
  truth: Poses | null;
  /** Of the frames with a truth. */
  nees?: (number | null)[];
}

interface ObjectJson {
  world: TrackJson;
  relative: TrackJson;
  detection: Poses;
  status: string[];
  mode_probability?: (number | null)[];
  existence?: (number | null)[];
  health?: string[];
  register_again?: boolean[];
  model_names?: string[];
  models?: (number[] | null)[];
  /** Squared Mahalanobis distance of the innovation, where a detection was used. */
  nis?: (number | null)[];
  alternatives?: { id: number; probability: number; pose: Pose }[][];
}

export interface TraceJson {
  name: string;
  method: string;
  frames: number;
  stamps_s: number[];
  order: string[];
  camera: TrackJson;
  objects: Record<string, ObjectJson>;
  hypotheses: { weight: number; poses: Poses }[][];
}

interface Slot {
  id: number;
  probability: number;
  pose: Pose;
}

export const STATUSES = ["none", "started", "used", "doubted", "birth", "gated", "failed"];
export const HEALTHS = ["none", "tentative", "good", "ambiguous", "inconsistent", "lost"];

function mask(frames: number, ...bits: (Poses | null | undefined)[]): Int32Array {
  const values = new Int32Array(frames);
  bits.forEach((poses, bit) => {
    for (let i = 0; i < frames; ++i) if (poses?.[i]) values[i] |= 1 << bit;
  });
  return values;
}

const rows = (values: (number | null)[] | undefined) => values?.map((value) => (value === null ? null : [value]));

function track(writer: TraceWriter, name: string, json: TrackJson): void {
  writer.addPoses(name, json.pose);
  writer.addRows(`${name}/log_sd`, 6, "int16", 1e-3, json.sd, "exp");
  const covariance = json.position_covariance;
  if (covariance) {
    const sd = covariance.map((c) => c && [c[0], c[3], c[5]].map(Math.sqrt));
    const rho = covariance.map((c, i) => {
      const s = sd[i];
      return c && s && [c[1] / (s[0] * s[1]), c[2] / (s[0] * s[2]), c[4] / (s[1] * s[2])];
    });
    writer.addRows(`${name}/position_log_sd`, 3, "int16", 1e-3, sd, "exp");
    writer.addRows(`${name}/position_correlation`, 3, "int16", 1 / 32767, rho);
  }
  if (json.truth) writer.addPoses(`${name}/truth`, json.truth);
  if (json.nees) writer.addRows(`${name}/nees`, 1, "int16", 5e-3, rows(json.nees)!, "exp");
}

/** Gives every hypothesis a slot for as long as it lives. */
export function assignSlots(frames: Slot[][]): (Slot | null)[][] {
  const slots: (Slot | null)[][] = [];
  const living: (number | null)[] = [];
  frames.forEach((list, frame) => {
    const ids = new Set(list.map((slot) => slot.id));
    living.forEach((id, k) => {
      if (id !== null && !ids.has(id)) living[k] = null;
    });
    for (const entry of list) {
      let k = living.indexOf(entry.id);
      if (k < 0) k = living.indexOf(null);
      if (k < 0) k = living.length;
      living[k] = entry.id;
      slots[k] ??= Array.from({ length: frames.length }, () => null);
      slots[k][frame] = entry;
    }
  });
  return slots;
}

function hypotheses(writer: TraceWriter, name: string, frames: Slot[][]): void {
  assignSlots(frames).forEach((slot, k) => {
    const at = `${name}/hypotheses/${k}`;
    writer.add({ name: `${at}/mask`, width: 1, type: "uint8", scale: 1, map: "linear" }, [slot.map((s) => (s ? 1 : 0))]);
    writer.addRows(`${at}/id`, 1, "int32", 1, slot.map((s) => s && [s.id]));
    writer.addRows(`${at}/probability`, 1, "uint16", 1 / 65535, slot.map((s) => s && [s.probability]));
    writer.addPoses(at, slot.map((s) => s && s.pose));
  });
}

/** Existence and health, and models of motion, where there are any. */
function tracks(writer: TraceWriter, name: string, object: ObjectJson): void {
  const head = (key: string) => ({ name: `${name}/${key}`, width: 1, type: "uint8", scale: 1, map: "linear" }) as const;
  if (object.existence) writer.addRows(`${name}/existence`, 1, "uint16", 1 / 65535, rows(object.existence)!);
  if (object.health) writer.add(head("health"), [object.health.map((word) => HEALTHS.indexOf(word))]);
  if (object.register_again) writer.add(head("register_again"), [object.register_again.map(Number)]);
  if (object.models && object.model_names) writer.addRows(`${name}/models`, object.model_names.length, "uint16", 1 / 65535, object.models);
}

function joint(json: TraceJson, index: number): Slot[][] {
  return json.hypotheses.map((list) =>
    list.flatMap(({ weight, poses }, k) => (poses[index] ? [{ id: k, probability: weight, pose: poses[index] }] : [])),
  );
}

export function packTrace(json: TraceJson): PackedTrace {
  const { frames } = json;
  const writer = new TraceWriter(frames);
  const head = (name: string) => ({ name, width: 1, type: "uint8", scale: 1, map: "linear" }) as const;
  writer.add(head("camera/mask"), [mask(frames, json.camera.pose, json.camera.truth)]);
  track(writer, "camera", json.camera);
  const many = json.order.length > 0 && json.objects[json.order[0]].alternatives !== undefined;
  if (!many) hypotheses(writer, "camera", joint(json, 0));
  json.order.forEach((id, index) => {
    const object = json.objects[id];
    const name = `objects/${id}`;
    const bits = [object.world.pose, object.world.truth, object.relative.pose, object.relative.truth, object.detection,
      rows(object.mode_probability), rows(object.existence), object.models, rows(object.nis)];
    writer.add({ ...head(`${name}/mask`), type: object.nis ? "uint16" : "uint8" }, [mask(frames, ...bits)]);
    if (object.nis) writer.addRows(`${name}/nis`, 1, "int16", 5e-3, rows(object.nis)!, "exp");
    track(writer, `${name}/world`, object.world);
    track(writer, `${name}/relative`, object.relative);
    writer.addPoses(`${name}/detection`, object.detection);
    writer.add(head(`${name}/status`), [object.status.map((status) => STATUSES.indexOf(status))]);
    if (object.mode_probability) writer.addRows(`${name}/mode_probability`, 1, "uint16", 1 / 65535, rows(object.mode_probability)!);
    tracks(writer, name, object);
    hypotheses(writer, name, object.alternatives ?? joint(json, index + 1));
  });
  const named = json.order.filter((id) => json.objects[id].model_names).map((id) => [id, json.objects[id].model_names!]);
  return writer.packed({
    name: json.name, method: json.method, order: json.order, stamps_s: json.stamps_s, statuses: STATUSES, healths: HEALTHS,
    models: Object.fromEntries(named) as Record<string, string[]>,
  });
}
