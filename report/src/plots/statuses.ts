// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The status of every detection, and the health of every track: a row per object.
import type uPlot from "uplot";
import type { Trace } from "../trace/trace.ts";
import type { Integers } from "../trace/decode.ts";
import { element } from "../ui/dom.ts";
import { HEALTH_MARKS, STATUS_MARKS } from "../ui/palette.ts";
import { themeColour } from "../ui/theme.ts";
import { Chart } from "./chart.ts";

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

/** Frames with equal values from `from` on. */
function endOf(values: Integers, from: number, frames: number): number {
  let to = from + 1;
  while (to < frames && values[to] === values[from]) ++to;
  return to;
}

/** Paints a band of marks per row; with `spoken` words stand in the bands where there is room. */
export function paintRows(trace: Trace, plot: uPlot, rows: Row[], words: readonly string[], marks: Marks, spoken = false): void {
  const { ctx } = plot;
  const { left, top, width, height } = plot.bbox;
  const x = (frame: number) => plot.valToPos(trace.seconds[Math.min(frame, trace.frames - 1)], "x", true);
  ctx.save();
  ctx.beginPath();
  ctx.rect(left, top, width, height);
  ctx.clip();
  ctx.font = `${10 * devicePixelRatio}px system-ui, sans-serif`;
  ctx.textAlign = "left";
  ctx.textBaseline = "bottom";
  rows.forEach(({ values, flag }, row) => {
    if (!values) return;
    const bottom = plot.valToPos(rows.length - 1 - row, "y", true);
    const full = 0.85 * (bottom - plot.valToPos(rows.length - row, "y", true));
    for (let from = 0; from < trace.frames; ) {
      const to = endOf(values, from, trace.frames);
      const word = words[values[from]];
      const mark = marks[word] ?? { colour: "#8A8A8A", height: 0.5, text: word };
      if (mark.colour !== "") {
        const [start, end] = [x(from), x(to)];
        ctx.fillStyle = mark.colour;
        ctx.fillRect(start, bottom - mark.height * full, Math.max(1.5, end - start), mark.height * full);
        const [low, high] = [Math.max(start, left), Math.min(end, left + width)];
        if (spoken && high - low > ctx.measureText(word).width + 8 * devicePixelRatio) {
          ctx.fillStyle = mark.height < 0.6 ? themeColour("--ink") : "#000000";
          ctx.fillText(word, low + 4 * devicePixelRatio, bottom - (mark.height < 0.6 ? mark.height * full : 0.12 * full));
        }
      }
      from = to;
    }
    ctx.fillStyle = themeColour("--ink");
    for (let from = 0; flag && from < trace.frames; ) {
      const to = endOf(flag, from, trace.frames);
      if (flag[from]) ctx.fillRect(x(from), bottom - full - 3 * devicePixelRatio, Math.max(1.5, x(to) - x(from)), 2 * devicePixelRatio);
      from = to;
    }
  });
  ctx.restore();
}

const rowNames = (trace: Trace) => trace.objects.map(({ id }) => (id.length > 13 ? `${id.slice(0, 12)}…` : id)).reverse();

export function statusChart(trace: Trace, seek: (seconds: number) => void): Chart {
  const count = trace.objects.length;
  return new Chart({
    title: "What became of the detections",
    x: trace.seconds,
    height: 44 + Math.max(3, count) * 26,
    series: [{ label: "status", values: new Array<null>(trace.frames).fill(null), kind: "dots" }],
    range: [0, count],
    yNames: rowNames(trace),
    seek,
    paint: (plot) => paintRows(trace, plot, trace.objects.map(({ status }) => ({ values: status })), trace.statuses, STATUS_MARKS),
  });
}

export function healthChart(trace: Trace, seek: (seconds: number) => void): Chart {
  const count = trace.objects.length;
  const rows = trace.objects.map(({ health, registerAgain }) => ({ values: health, flag: registerAgain }));
  return new Chart({
    title: "health of the tracks",
    x: trace.seconds,
    height: 44 + Math.max(3, count) * 32,
    series: [{ label: "health", values: new Array<null>(trace.frames).fill(null), kind: "dots" }],
    range: [0, count],
    yNames: rowNames(trace),
    seek,
    paint: (plot) => paintRows(trace, plot, rows, trace.healths, HEALTH_MARKS, true),
  });
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
