// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// How poses are written, in the table and on the cards: in which frame of reference, and the rotation as what.
import { DEGREES, type Numbers, rollPitchYaw, rotationVector } from "../math/rotation.ts";
import type { Estimate, ObjectTrack, Trace } from "../trace/trace.ts";
import { fixed, short } from "../ui/numbers.ts";
import { OneOf } from "./setting.ts";

export type Reference = "world" | "camera";
export type RotationForm = "rpy" | "vector" | "quaternion";
const ROTATION_FORMS: readonly (readonly [RotationForm, string])[] = [
  ["rpy", "roll, pitch, yaw"], ["vector", "rotation vector"], ["quaternion", "quaternion x y z w"],
];

const r = [0, 0, 0];

/** A rotation as text. */
export function rotationText(q: Numbers, form: RotationForm): string {
  const sign = q[3] < 0 ? -1 : 1;
  if (form === "quaternion") return [0, 1, 2, 3].map((i) => fixed(sign * q[i], 4)).join(", ");
  const positive = [0, 1, 2, 3].map((i) => sign * q[i]);
  if (form === "rpy") rollPitchYaw(positive, r);
  else rotationVector(positive, r);
  return r.map((angle) => fixed(angle * DEGREES, 1)).join(", ");
}

/** A frame's pose and its three sigmas, the numbers of a row. */
export class PoseReading {
  readonly p = [0, 0, 0];
  readonly q = [0, 0, 0, 1];
  /** Three standard deviations: position [mm], rotation [deg]; NaN where they are not known. */
  readonly place = [0, 0, 0];
  readonly turn = [0, 0, 0];

  /** Whether there is a pose at the frame. */
  read(estimate: Estimate | undefined, frame: number): boolean {
    if (!estimate?.pose.has(frame)) return false;
    estimate.pose.position(frame, this.p);
    estimate.pose.quaternion(frame, this.q);
    estimate.positionSdAt(frame, this.place);
    estimate.rotationSd(frame, this.turn);
    for (let i = 0; i < 3; ++i) {
      this.place[i] *= 3000;
      this.turn[i] *= 3 * DEGREES;
    }
    return true;
  }
}

/** Three numbers after "±", or nothing where there are none. */
export function sigmaText(values: readonly number[], unit = ""): string {
  return values.some(Number.isNaN) ? "" : `± ${values.map(short).join(", ")} ${unit}`.trim();
}

export class PoseDisplay {
  readonly reference = new OneOf<Reference>([["world", "the world"], ["camera", "the camera"]], "world");
  readonly rotation = new OneOf<RotationForm>(ROTATION_FORMS, "rpy");

  on(change: () => void): void {
    this.reference.onChange(change);
    this.rotation.onChange(change);
  }

  get of(): Reference {
    return this.reference.value;
  }

  get form(): RotationForm {
    return this.rotation.value;
  }

  /** The estimate of an object in the chosen frame; of the camera in the world. */
  estimate(trace: Trace, entity: number): Estimate | undefined {
    if (entity < 0) return this.of === "world" ? trace.camera : undefined;
    const object: ObjectTrack = trace.objects[entity];
    return this.of === "world" ? object.world : object.relative;
  }
}
