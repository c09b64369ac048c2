// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A pose as text for other programs.
import { matrixOf } from "../math/rotation.ts";
import { fixed } from "./numbers.ts";

export interface NamedPose {
  /** The frame of reference, and what is posed in it. */
  from: string;
  to: string;
  stamp: number;
  p: readonly number[];
  q: readonly number[];
}

export const POSE_FORMS = { quaternion: "tx ty tz qx qy qz qw", matrix: "4x4 matrix", ros: "ROS YAML" } as const;
export type PoseForm = keyof typeof POSE_FORMS;

const number = (value: number) => fixed(value, 9).replace(/\.?0+$/, "");

function matrixText({ p, q }: NamedPose): string {
  const m = [0, 0, 0, 0, 0, 0, 0, 0, 0];
  matrixOf([...q], m);
  const rows = [0, 1, 2].map((i) => `[${[m[3 * i], m[3 * i + 1], m[3 * i + 2], p[i]].map(number).join(", ")}]`);
  return `[${[...rows, "[0, 0, 0, 1]"].join(",\n ")}]`;
}

/** geometry_msgs/PoseStamped; names are quoted, so that any name is one text. */
function rosText({ from, to, stamp, p, q }: NamedPose): string {
  const sec = Math.floor(stamp);
  const nanosec = Math.min(999_999_999, Math.round((stamp - sec) * 1e9));
  const list = (names: string, values: readonly number[]) => [...names].map((name, i) => `${name}: ${number(values[i])}`).join(", ");
  return [
    `# ${JSON.stringify(to)} in ${JSON.stringify(from)}`,
    "header:", `  stamp: {sec: ${sec}, nanosec: ${nanosec}}`, `  frame_id: ${JSON.stringify(from)}`,
    "pose:", `  position: {${list("xyz", p)}}`, `  orientation: {${list("xyzw", q)}}`, "",
  ].join("\n");
}

export function poseText(pose: NamedPose, form: PoseForm): string {
  if (form === "matrix") return matrixText(pose);
  if (form === "ros") return rosText(pose);
  return [...pose.p, ...pose.q].map(number).join(" ");
}

/** Puts a text on the clipboard; whether the browser let it. */
export async function copyText(text: string): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    // Pages from files may not use the clipboard's interface in some browsers; the old way needs a field with the text.
    const field = document.createElement("textarea");
    field.value = text;
    field.setAttribute("aria-hidden", "true");
    field.style.position = "fixed";
    document.body.append(field);
    field.select();
    const done = document.execCommand("copy");
    field.remove();
    return done;
  }
}
