// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Decodes the packed trace into typed arrays.
import { BadPayload, type ColumnHead, type PackedTrace } from "../payload.ts";

export type Integers = Uint8Array | Uint16Array | Int16Array | Int32Array;

const ARRAYS = { uint8: Uint8Array, uint16: Uint16Array, int16: Int16Array, int32: Int32Array } as const;

/** One quantity over the frames: integers by component, and the mapping to values. */
export class Column {
  constructor(
    readonly head: ColumnHead,
    readonly components: readonly Integers[],
  ) {}

  value(component: number, frame: number): number {
    const number = this.components[component][frame] * this.head.scale;
    return this.head.map === "exp" ? Math.exp(number) : number;
  }
}

export type Columns = ReadonlyMap<string, Column>;

export function bytesOfBase64(text: string): Uint8Array<ArrayBuffer> {
  let binary: string;
  try {
    binary = atob(text);
  } catch {
    throw new BadPayload("The trace is not valid base64.");
  }
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

/** Unpacks a zlib stream of a known length. */
export async function inflate(packed: Uint8Array<ArrayBuffer>, length: number): Promise<Uint8Array> {
  if (typeof DecompressionStream === "undefined") {
    throw new BadPayload("This browser cannot unpack the trace (it has no DecompressionStream); a newer one can.");
  }
  const reader = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate")).getReader();
  const bytes = new Uint8Array(length);
  let filled = 0;
  for (;;) {
    let part: ReadableStreamReadResult<Uint8Array>;
    try {
      part = await reader.read();
    } catch {
      throw new BadPayload("The trace is damaged: it cannot be unpacked.");
    }
    if (part.done) break;
    if (filled + part.value.length > length) {
      await reader.cancel();
      throw new BadPayload(`The trace is longer than its columns say, ${length} bytes.`);
    }
    bytes.set(part.value, filled);
    filled += part.value.length;
  }
  if (filled !== length) throw new BadPayload(`The trace has ${filled} bytes, its columns say ${length}.`);
  return bytes;
}

function checkHead(head: ColumnHead): void {
  const known = head !== null && typeof head === "object" && Object.hasOwn(ARRAYS, head.type);
  if (!known || !Number.isInteger(head.width) || head.width < 1 || !Number.isFinite(head.scale)) {
    throw new BadPayload(`The trace has a column that this page cannot read: ${JSON.stringify(head)}.`);
  }
}

/** Undoes byte planes, folded signs and differences of one component, whose bytes begin at `start`. */
export function decodeComponent(bytes: Uint8Array, start: number, frames: number, { type, fold }: ColumnHead): Integers {
  const values = new ARRAYS[type](frames);
  const width = values.BYTES_PER_ELEMENT;
  const second = start + frames;
  const third = second + frames;
  const fourth = third + frames;
  let last = 0;
  // Storing truncates to the width of the column, as the encoding intends.
  for (let i = 0; i < frames; ++i) {
    let difference = bytes[start + i];
    if (width > 1) difference |= bytes[second + i] << 8;
    if (width > 2) difference |= (bytes[third + i] << 16) | (bytes[fourth + i] << 24);
    if (fold) difference = (difference >>> 1) ^ -(difference & 1);
    values[i] = last = (last + difference) | 0;
  }
  return values;
}

export async function decodeColumns(trace: PackedTrace): Promise<Columns> {
  const { frames } = trace;
  let length = 0;
  for (const head of trace.columns) {
    checkHead(head);
    length += head.width * frames * ARRAYS[head.type].BYTES_PER_ELEMENT;
  }
  const bytes = await inflate(bytesOfBase64(trace.data), length);
  const columns = new Map<string, Column>();
  let start = 0;
  for (const head of trace.columns) {
    const components: Integers[] = [];
    for (let k = 0; k < head.width; ++k) {
      components.push(decodeComponent(bytes, start, frames, head));
      start += frames * ARRAYS[head.type].BYTES_PER_ELEMENT;
    }
    columns.set(head.name, new Column(head, components));
  }
  return columns;
}
