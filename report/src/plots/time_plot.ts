// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Series over time as a vector drawing, for print. Of many frames only the extremes within a pixel are drawn.
import { svg, widthOf } from "../ui/svg.ts";
import { axisBelow, axisLeft, FONT, type Frame, text } from "./drawing.ts";
import { scaleOf, tickText } from "./scale.ts";

export interface TimeSeries {
  name: string;
  colour: string;
  values: ArrayLike<number | null>;
  look?: "line" | "dashed" | "shade";
}

export interface TimePlot {
  title: string;
  seconds: ArrayLike<number>;
  series: TimeSeries[];
  width: number;
  height: number;
  range?: [number, number];
}

/** A path through a series: per pixel its first, least, greatest and last value, with a gap where there is none. */
export function tracePath(values: ArrayLike<number | null>, x: (frame: number) => number, y: (value: number) => number): string {
  let path = "";
  let pixel = NaN;
  let [low, high, last] = [0, 0, 0];
  let open = false;
  const flush = () => {
    if (!open || Number.isNaN(pixel)) return;
    if (high - low > 0.5) path += `L${pixel} ${low.toFixed(1)}L${pixel} ${high.toFixed(1)}`;
    path += `L${pixel} ${last.toFixed(1)}`;
  };
  for (let frame = 0; frame < values.length; ++frame) {
    const value = values[frame];
    if (value === null || value === undefined || Number.isNaN(value)) {
      flush();
      open = false;
      pixel = NaN;
      continue;
    }
    const [at, up] = [Math.round(2 * x(frame)) / 2, y(value)];
    if (!open) path += `M${at} ${up.toFixed(1)}`;
    if (at !== pixel) {
      flush();
      [pixel, low, high] = [at, up, up];
    }
    [low, high, last, open] = [Math.min(low, up), Math.max(high, up), up, true];
  }
  flush();
  return path;
}

/** The area between a series and zero, span by span. */
function shadePath(values: ArrayLike<number | null>, x: (frame: number) => number, y: (value: number) => number, zero: number): string {
  let path = "";
  let first = -1;
  for (let frame = 0; frame <= values.length; ++frame) {
    const isThere = frame < values.length && values[frame] !== null;
    if (isThere && first < 0) first = frame;
    if (isThere || first < 0) continue;
    const part = Array.from({ length: values.length }, (_, i) => (i >= first && i < frame ? (values[i] as number | null) : null));
    path += `${tracePath(part, x, y)}L${x(frame - 1).toFixed(1)} ${zero}L${x(first).toFixed(1)} ${zero}Z`;
    first = -1;
  }
  return path;
}

export function timePlot({ title, seconds, series, width, height, range }: TimePlot): SVGSVGElement {
  const sizes = series.flatMap(({ values }) => Array.from(values).filter((value): value is number => value !== null));
  const fit = range ? scaleOf(range, { most: Math.max(2, Math.floor(height / 45)), tight: true }) : scaleOf(sizes.concat(0), { most: Math.max(2, Math.floor(height / 45)) });
  const left = 12 + Math.max(...fit.ticks.map((tick) => widthOf(tickText(tick), FONT)), 20);
  const frame: Frame = { left, right: width - 10, top: 22, bottom: height - 2 * FONT - 8 };
  const across = scaleOf([seconds[0], seconds[seconds.length - 1]], { most: Math.floor(width / 80), tight: true });
  const x = (i: number) => frame.left + across.at(seconds[i]) * (frame.right - frame.left);
  const y = (value: number) => frame.bottom - Math.max(0, Math.min(1, fit.at(value))) * (frame.bottom - frame.top);
  const names = series.map(({ name }) => name).join(", ");
  const node = svg("svg", { viewBox: `0 0 ${width} ${height}`, width, height, role: "img", "aria-label": `${title} over time: ${names}.`, class: "table-chart" });
  node.append(...axisLeft(fit, frame), ...axisBelow(across, { ...frame, top: frame.bottom }), text(2, 13, title, "start", "label strong"),
    text(frame.right, height - 3, "time [s]", "end", "label"));
  for (const { colour, values, look } of series) {
    if (look === "shade") node.append(svg("path", { d: shadePath(values, x, y, y(0)), fill: colour, opacity: 0.18 }));
    else node.append(svg("path", { d: tracePath(values, x, y), stroke: colour, class: look === "dashed" ? "curve dashed" : "curve" }));
  }
  return node;
}
