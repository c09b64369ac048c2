// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Frames in which something is so, as spans from its first frame to its last.

export interface Span {
  from: number;
  to: number;
  /** Number of occurrences in it. */
  count: number;
  /** The frame where it is worst, and how bad it is there. */
  peak: number;
  size: number;
}

/** Joins a later span, if less than `gap` frames are between; otherwise undefined. */
export function joined<T extends Span>(first: T, second: T, gap: number): T | undefined {
  if (second.from - first.to > gap) return undefined;
  const worse = second.size > first.size ? second : first;
  return { ...worse, from: first.from, to: Math.max(first.to, second.to), count: first.count + second.count };
}

/** Joins successive spans of a list that is in order. */
export function joinAll<T extends Span>(spans: readonly T[], gap: number): T[] {
  const out: T[] = [];
  for (const span of spans) {
    const both = out.length > 0 ? joined(out[out.length - 1], span, gap) : undefined;
    if (both) out[out.length - 1] = both;
    else out.push(span);
  }
  return out;
}

/** Spans of the frames whose size is above zero, across at most `gap` frames where it is not. */
export function spansOf(frames: number, sizeAt: (frame: number) => number, gap: number): Span[] {
  const out: Span[] = [];
  let last: Span | undefined;
  for (let frame = 0; frame < frames; ++frame) {
    const size = sizeAt(frame);
    if (!(size > 0)) continue;
    if (last && frame - last.to <= gap) {
      last.to = frame;
      ++last.count;
      if (size > last.size) [last.size, last.peak] = [size, frame];
    } else out.push((last = { from: frame, to: frame, count: 1, peak: frame, size }));
  }
  return out;
}
