// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The status of every detection, and the health of every track: a row per object.
import type { RunState } from "../state/run_state.ts";
import type { Integers } from "../trace/decode.ts";
import type { Trace } from "../trace/trace.ts";
import { element } from "../ui/dom.ts";
import { HEALTH_MARKS, STATUS_MARKS } from "../ui/palette.ts";
import { themeColour } from "../ui/theme.ts";
import { Chart, type Rows } from "./chart.ts";
import { faded7 } from "./chart_options.ts";
import type { Field, Pen } from "./pen.ts";
import { type Run, runsOf, spansOf } from "./runs.ts";

const LEAST = 3;
const SPARE = 0.14;

/** Number of detections of every status, by object. */
export function countStatuses(trace: Trace): number[][] {
  return trace.objects.map(({ status }) => {
    const counts = trace.statuses.map(() => 0);
    if (status) for (let frame = 0; frame < trace.frames; ++frame) ++counts[status[frame]];
    return counts;
  });
}

export type Marks = typeof STATUS_MARKS;

/** What is painted in one row: a mark per frame, and a line above it where `flag` is one. */
export interface Row {
  values: Integers | undefined;
  flag?: Integers | undefined;
}

interface Band {
  runs: Run[];
  flags: Run[];
}

const markOf = (word: string | undefined, marks: Marks) => marks[word ?? ""] ?? { colour: "#8A8A8A", height: 0.5, text: word ?? "" };

/** The middle of a row and the height that its marks may have. */
function place(field: Field, row: number, count: number): { middle: number; full: number; top: number; height: number } {
  const top = field.y(count - row);
  const height = field.y(count - row - 1) - top;
  return { top, height, middle: top + height / 2, full: (1 - 2 * SPARE) * height };
}

function paintBand(pen: Pen, field: Field, band: Band, at: ReturnType<typeof place>, words: readonly string[], marks: Marks, x: (frame: number) => number, spoken: boolean): void {
  const { middle, full } = at;
  const rank = (value: number) => (markOf(words[value], marks).colour === "" ? -1 : markOf(words[value], marks).height);
  const right = field.left + field.width;
  for (const { start, end, value } of spansOf(band.runs, x, LEAST * field.pixel, rank)) {
    if (end < field.left || start > right) continue;
    const { colour, height } = markOf(words[value], marks);
    const [low, high] = [Math.max(start, field.left), Math.min(end, right)];
    pen.rect(low, middle - (height * full) / 2, high - low, height * full, colour);
    if (!spoken || high - low < pen.widthOf(words[value], 10) + 8 * field.pixel) continue;
    // Beside a thin band there is room above it only.
    const inside = height >= 0.5;
    pen.text(words[value], low + 4 * field.pixel, inside ? middle : middle - (height * full) / 2 - 6 * field.pixel, inside ? "#000000" : themeColour("--ink"), { size: 10 });
  }
  for (const { from, to, value } of band.flags) {
    if (value !== 0) pen.rect(x(from), middle - full / 2 - 3 * field.pixel, Math.max(LEAST * field.pixel, x(to) - x(from)), 2 * field.pixel, themeColour("--ink"));
  }
}

/** Paints a band of marks per row; with `spoken` words stand in the bands where there is room. */
function painter(state: RunState, bands: Band[], words: readonly string[], marks: Marks, spoken: boolean) {
  const { trace } = state;
  return (pen: Pen, field: Field) => {
    const x = (frame: number) => field.x(trace.seconds[Math.min(frame, trace.frames - 1)]);
    bands.forEach((band, row) => {
      const at = place(field, row, bands.length);
      if (state.selected === row) pen.rect(field.left, at.top, field.width, at.height, faded7(themeColour("--accent"), 0.14));
      if (row > 0) pen.line([field.left, at.top, field.left + field.width, at.top], themeColour("--line"), field.pixel);
      paintBand(pen, field, band, at, words, marks, x, spoken);
    });
  };
}

const rowNames = (trace: Trace) => trace.objects.map(({ id }) => (id.length > 13 ? `${id.slice(0, 12)}…` : id)).reverse();

function rowsOf(trace: Trace, rows: Row[], words: readonly string[]): Rows {
  const known = trace.objects.map(({ id }, i) => ({ id, values: rows[i].values }));
  return {
    columns: ["time [s]", ...known.map(({ id }) => id)],
    rows: Array.from(trace.seconds, (seconds, frame) => [seconds, ...known.map(({ values }) => (values ? (words[values[frame]] ?? null) : null))]),
  };
}

interface RowChart {
  title: string;
  rows: Row[];
  words: readonly string[];
  marks: Marks;
  rowHeight: number;
  spoken: boolean;
}

function rowChart(state: RunState, { title, rows, words, marks, rowHeight, spoken }: RowChart): Chart {
  const { trace } = state;
  const bands = rows.map(({ values, flag }) => ({ runs: values ? runsOf(values) : [], flags: flag ? runsOf(flag) : [] }));
  const chart = new Chart({
    title,
    x: trace.seconds,
    height: 52 + Math.max(2, rows.length) * rowHeight,
    series: [{ label: title, values: new Array<null>(trace.frames).fill(null), kind: "dots" }],
    range: [0, rows.length],
    yNames: rowNames(trace),
    seek: (seconds) => state.seek(seconds),
    pressRow: (row) => state.select(row),
    paint: painter(state, bands, words, marks, spoken),
    rows: () => rowsOf(trace, rows, words),
    keys: wordsThatOccur(rows, words).flatMap((label) => (markOf(label, marks).colour === "" ? [] : [{ label, colour: markOf(label, marks).colour }])),
  });
  return chart;
}

export function statusChart(state: RunState): Chart {
  const { objects, statuses } = state.trace;
  const rows = objects.map(({ status }) => ({ values: status }));
  return rowChart(state, { title: "status of the detections", rows, words: statuses, marks: STATUS_MARKS, rowHeight: 26, spoken: false });
}

export function healthChart(state: RunState): Chart {
  const { objects, healths } = state.trace;
  const rows = objects.map(({ health, registerAgain }) => ({ values: health, flag: registerAgain }));
  return rowChart(state, { title: "health of the tracks", rows, words: healths, marks: HEALTH_MARKS, rowHeight: 34, spoken: true });
}

/** The words that occur in some row. */
export function wordsThatOccur(rows: readonly Row[], words: readonly string[]): string[] {
  const seen = new Set<number>();
  for (const { values } of rows) values?.forEach((value) => seen.add(value));
  return words.filter((_, value) => seen.has(value));
}

/** The words of marks beside their colours and heights. */
export function marksLegend(words: readonly string[], marks: Marks): HTMLElement {
  const legend = element("ul", { class: "legend" });
  for (const name of words) {
    const mark = marks[name];
    if (!mark || mark.colour === "") continue;
    const key = element("span", { class: "swatch" });
    key.style.background = mark.colour;
    key.style.height = `${mark.height}em`;
    legend.append(element("li", {}, key, mark.text === name ? name : `${name}: ${mark.text}`));
  }
  return legend;
}
