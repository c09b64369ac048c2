// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The status of every detection: a row per object.
import type uPlot from "uplot";
import type { Trace } from "../trace/trace.ts";
import { STATUS_MARKS } from "../ui/palette.ts";
import { Chart } from "./chart.ts";

/** Number of detections of every status, by object. */
export function countStatuses(trace: Trace): number[][] {
  return trace.objects.map(({ status }) => {
    const counts = trace.statuses.map(() => 0);
    if (status) for (let frame = 0; frame < trace.frames; ++frame) ++counts[status[frame]];
    return counts;
  });
}

function paint(trace: Trace, plot: uPlot): void {
  const { ctx } = plot;
  const { left, top, width, height } = plot.bbox;
  const count = trace.objects.length;
  ctx.save();
  ctx.beginPath();
  ctx.rect(left, top, width, height);
  ctx.clip();
  trace.objects.forEach(({ status }, row) => {
    if (!status) return;
    const bottom = plot.valToPos(count - 1 - row, "y", true);
    const full = 0.85 * (bottom - plot.valToPos(count - row, "y", true));
    for (let from = 0; from < trace.frames; ) {
      let to = from + 1;
      while (to < trace.frames && status[to] === status[from]) ++to;
      const mark = STATUS_MARKS[trace.statuses[status[from]]] ?? { colour: "#8A8A8A", height: 0.5 };
      if (mark.colour !== "") {
        const x = plot.valToPos(trace.seconds[from], "x", true);
        const end = plot.valToPos(trace.seconds[Math.min(to, trace.frames - 1)], "x", true);
        ctx.fillStyle = mark.colour;
        ctx.fillRect(x, bottom - mark.height * full, Math.max(1.5, end - x), mark.height * full);
      }
      from = to;
    }
  });
  ctx.restore();
}

export function statusChart(trace: Trace, seek: (seconds: number) => void): Chart {
  const count = trace.objects.length;
  return new Chart({
    title: "What became of the detections",
    x: trace.seconds,
    height: 44 + Math.max(3, count) * 26,
    series: [{ label: "status", values: new Array<null>(trace.frames).fill(null), kind: "dots" }],
    range: [0, count],
    yNames: trace.objects.map(({ id }) => (id.length > 13 ? `${id.slice(0, 12)}…` : id)).reverse(),
    seek,
    paint: (plot) => paint(trace, plot),
  });
}
