// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Runs of equal values along the frames, and which of them a row of pixels shows.
import type { Integers } from "../trace/decode.ts";

export interface Run {
  from: number;
  /** The frame after its last. */
  to: number;
  value: number;
}

export function runsOf(values: Integers): Run[] {
  const runs: Run[] = [];
  for (let from = 0; from < values.length; ) {
    let to = from + 1;
    while (to < values.length && values[to] === values[from]) ++to;
    runs.push({ from, to, value: values[from] });
    from = to;
  }
  return runs;
}

export interface Span {
  start: number;
  end: number;
  value: number;
}

/**
 * Where runs are painted: none is narrower than `least`, and of narrow ones that would lie on one another the one of
 * the higher rank remains, so that a single frame of many thousand is seen. Wide ones come first, to be painted below.
 */
export function spansOf(runs: readonly Run[], x: (frame: number) => number, least: number, rank: (value: number) => number): Span[] {
  const wide: Span[] = [];
  const narrow: Span[] = [];
  for (const { from, to, value } of runs) {
    if (rank(value) < 0) continue;
    const [start, end] = [x(from), x(to)];
    if (end - start >= least) {
      wide.push({ start, end, value });
      continue;
    }
    const middle = 0.5 * (start + end);
    const span = { start: middle - least / 2, end: middle + least / 2, value };
    const last = narrow[narrow.length - 1];
    if (!last || span.start >= last.end) narrow.push(span);
    else if (last.value === value) last.end = span.end;
    else if (rank(value) > rank(last.value)) {
      // A long mark of the same kind keeps what does not lie below the other one.
      if (last.end - last.start <= 1.5 * least) narrow.pop();
      else last.end = span.start;
      narrow.push(span);
    }
  }
  return [...wide, ...narrow];
}
