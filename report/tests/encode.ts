// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Packs traces as the program does, for tests.
import { deflateSync } from "node:zlib";
import type { ColumnHead, PackedTrace } from "../src/payload.ts";

const BYTES = { uint8: 1, uint16: 2, int16: 2, int32: 4 } as const;
type Row = ArrayLike<number> | null;

/** Takes differences along the frames, with `fold` their signs into the lowest bit, and splits them into byte planes. */
export function encodeComponent(values: ArrayLike<number>, { type, fold }: ColumnHead, out: Uint8Array, start: number): void {
  const bytes = BYTES[type];
  const unused = 32 - 8 * bytes;
  const frames = values.length;
  let last = 0;
  for (let i = 0; i < frames; ++i) {
    const difference = ((values[i] - last) << unused) >> unused;
    const stored = fold ? (difference << 1) ^ (difference >> 31) : difference;
    last = values[i];
    for (let plane = 0; plane < bytes; ++plane) out[start + plane * frames + i] = (stored >>> (8 * plane)) & 0xff;
  }
}

export class TraceWriter {
  private readonly heads: ColumnHead[] = [];
  private readonly parts: Uint8Array[] = [];

  constructor(private readonly frames: number) {}

  /** Integers of every component. */
  add(column: ColumnHead, components: ArrayLike<number>[]): void {
    const head = { fold: true, ...column };
    const size = BYTES[head.type] * this.frames;
    const bytes = new Uint8Array(size * head.width);
    components.forEach((values, k) => encodeComponent(values, head, bytes, k * size));
    this.heads.push(head);
    this.parts.push(bytes);
  }

  /** Quantised rows; a missing row repeats the one before it. */
  addRows(name: string, width: number, type: ColumnHead["type"], scale: number, rows: Row[], map: ColumnHead["map"] = "linear"): void {
    const components = Array.from({ length: width }, () => new Int32Array(this.frames));
    for (let i = 0; i < this.frames; ++i) {
      const row = rows[i];
      for (let k = 0; k < width; ++k) {
        const value = row ? (map === "exp" ? Math.log(Math.max(row[k], 1e-13)) : row[k]) : NaN;
        components[k][i] = row ? Math.round(value / scale) : i > 0 ? components[k][i - 1] : 0;
      }
    }
    this.add({ name, width, type, scale, map }, components);
  }

  addQuaternions(name: string, rows: Row[]): void {
    let last = [0, 0, 0, 1];
    const continuous = rows.map((row) => {
      if (!row) return null;
      const sign = last.reduce((sum, value, i) => sum + value * row[i], 0) < 0 ? -1 : 1;
      last = Array.from(row, (value) => sign * value);
      return last;
    });
    this.addRows(name, 4, "int16", 1 / 32767, continuous);
  }

  /** A pose as [tx, ty, tz, qx, qy, qz, qw]. */
  addPoses(name: string, poses: (number[] | null)[]): void {
    this.addRows(`${name}/position`, 3, "int32", 1e-5, poses.map((pose) => pose && pose.slice(0, 3)));
    this.addQuaternions(`${name}/quaternion`, poses.map((pose) => pose && pose.slice(3)));
  }

  packed(head: Omit<PackedTrace, "columns" | "data" | "frames">): PackedTrace {
    const data = deflateSync(Buffer.concat(this.parts), { level: 6 }).toString("base64");
    return { ...head, frames: this.frames, columns: this.heads, data };
  }
}
