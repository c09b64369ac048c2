// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Drawings of the points of a table. Words stand in rows, where there is room to read them, and are not joined by lines, since they have no order.
import type { Line, Panel, Point } from "../study/aggregate.ts";
import { formatted } from "../ui/format.ts";
import { colourOf } from "../ui/palette.ts";
import { shortened, svg, widthOf } from "../ui/svg.ts";
import { axisBelow, axisLeft, FONT, type Frame, line, mark, text } from "./drawing.ts";
import { type Scale, scaleOf, tickText } from "./scale.ts";

export interface TableChart {
  title: string;
  xLabel: string;
  yLabel: string;
  names: string[];
  words: boolean;
  panel: Panel;
  log: boolean;
  height?: number;
  /** Whether the quantity stands in a caption, and need not in the drawing. */
  isCaptioned?: boolean;
}

function values({ lines }: Panel): number[] {
  return lines.flatMap(({ points }) => points.flatMap(({ value, low, high }) => [value, ...(low === undefined ? [] : [low]), ...(high === undefined ? [] : [high])]));
}

/** Bars may reach below zero where their values do not; a logarithmic scale then has the values alone. */
function valueScale(chart: TableChart, most: number): Scale {
  const all = values(chart.panel);
  const isPositive = chart.panel.lines.every(({ points }) => points.every(({ value }) => value > 0));
  return scaleOf(chart.log && isPositive ? all.filter((value) => value > 0) : all, { log: chart.log, most });
}

function describe(line: Line, { value, low, high, rows, x }: Point, label: string): SVGElement {
  const bar = low === undefined || high === undefined ? "" : ` (${formatted(low)} to ${formatted(high)})`;
  return svg("title", {}, `${line.group ? `${line.group}, ` : ""}${x}: ${formatted(value)}${bar}, ${label}; ${rows} ${rows === 1 ? "row" : "rows"}`);
}

function summary({ title, panel, names, words, xLabel }: TableChart): string {
  const groups = panel.lines.map(({ group }) => group).filter((group) => group !== "");
  const count = panel.lines.reduce((sum, { points }) => sum + points.length, 0);
  return `${title} against ${xLabel}${groups.length > 0 ? `, for ${groups.join(", ")}` : ""}; ${count} points${words ? ` at ${names.length} names` : ""}.`;
}

function root(chart: TableChart, width: number, height: number): SVGSVGElement {
  return svg("svg", { width, height, viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": summary(chart), class: "table-chart" });
}

function drawRows(chart: TableChart, width: number): SVGSVGElement {
  const { panel } = chart;
  const names = chart.names.filter((name) => panel.lines.some(({ points }) => points.some(({ x }) => String(x) === name)));
  const count = panel.lines.length;
  const rowHeight = Math.max(22, Math.min(9, 140 / count) * count + 8);
  const side = Math.min(0.4 * width, 16 + Math.max(...names.map((name) => widthOf(name, FONT)), 20));
  const isTall = rowHeight * names.length > 420;
  const top = isTall ? FONT + 12 : 6;
  const frame: Frame = { left: side, right: width - 14, top, bottom: top + rowHeight * names.length };
  const height = frame.bottom + 2 * FONT + 16;
  const scale = valueScale(chart, Math.max(3, Math.min(10, Math.floor((frame.right - frame.left) / 70))));
  const at = (value: number) => frame.left + Math.max(0, Math.min(1, scale.at(value))) * (frame.right - frame.left);
  const node = root(chart, width, height);
  names.forEach((name, i) => {
    const y = frame.top + rowHeight * i;
    if (i % 2 === 1) node.append(svg("rect", { x: 0, y, width, height: rowHeight, class: "stripe" }));
    node.append(text(side - 8, y + rowHeight / 2 + 4, shortened(name, FONT, side - 12), "end", "name"));
  });
  // The numbers of a long list stand above it too.
  if (isTall) node.append(...scale.ticks.map((tick) => text(at(tick), FONT, tickText(tick), "middle")));
  node.append(...axisBelow(scale, frame), text((frame.left + frame.right) / 2, height - 4, chart.yLabel, "middle", "label"));
  const step = (rowHeight - 8) / Math.max(1, count);
  panel.lines.forEach((one, k) => {
    const colour = colourOf(one.index);
    for (const point of one.points) {
      const y = frame.top + rowHeight * names.indexOf(String(point.x)) + 4 + step * (k + 0.5);
      const group = svg("g", { "data-group": one.group, "data-x": String(point.x), "data-value": String(point.value), "data-rows": point.rows }, describe(one, point, chart.yLabel));
      if (point.low !== undefined && point.high !== undefined) group.append(line(at(point.low), y, at(point.high), y, "bar", colour));
      group.append(mark(one.index, at(point.value), y, colour, Math.min(4.2, Math.max(2.6, step / 2))));
      node.append(group);
    }
  });
  return node;
}

function drawLines(chart: TableChart, width: number): SVGSVGElement {
  const { panel } = chart;
  const height = chart.height ?? Math.max(280, Math.min(520, 0.36 * width));
  const scale = valueScale(chart, Math.max(3, Math.floor(height / 50)));
  const side = 24 + Math.max(...scale.ticks.map((tick) => widthOf(tickText(tick), FONT)), 24);
  const frame: Frame = { left: side, right: width - 14, top: chart.isCaptioned ? 10 : 24, bottom: height - 2 * FONT - 14 };
  const across = scaleOf(panel.lines.flatMap(({ points }) => points.map(({ x }) => x as number)), { most: Math.max(3, Math.floor((frame.right - side) / 70)) });
  // A few values, such as levels, are marked themselves.
  const levels = [...new Set(panel.lines.flatMap(({ points }) => points.map((point) => point.x as number)))].sort((a, b) => a - b);
  if (levels.length <= 12) across.ticks = levels;
  const x = (value: number) => frame.left + across.at(value) * (frame.right - frame.left);
  const y = (value: number) => frame.bottom - Math.max(0, Math.min(1, scale.at(value))) * (frame.bottom - frame.top);
  const node = root(chart, width, height);
  node.append(...axisLeft(scale, frame), ...axisBelow(across, { ...frame, top: frame.bottom }),
    ...(chart.isCaptioned ? [] : [text(2, 13, chart.yLabel, "start", "label strong")]), text((frame.left + frame.right) / 2, height - 4, chart.xLabel, "middle", "label"));
  const dense = panel.lines.some(({ points }) => points.length > 80);
  for (const one of panel.lines) {
    const colour = colourOf(one.index);
    const path = one.points.map((point, i) => `${i === 0 ? "M" : "L"}${x(point.x as number).toFixed(1)} ${y(point.value).toFixed(1)}`).join("");
    node.append(svg("path", { d: path, class: "curve", stroke: colour }));
    if (dense) continue;
    for (const point of one.points) {
      const px = x(point.x as number);
      const group = svg("g", { "data-group": one.group, "data-x": String(point.x), "data-value": String(point.value), "data-rows": point.rows }, describe(one, point, chart.yLabel));
      if (point.low !== undefined && point.high !== undefined) group.append(line(px, y(point.low), px, y(point.high), "bar", colour));
      group.append(mark(one.index, px, y(point.value), colour));
      node.append(group);
    }
  }
  return node;
}

/** One panel of a chart at a width. */
export function drawTable(chart: TableChart, width: number): SVGSVGElement {
  return chart.words ? drawRows(chart, width) : drawLines(chart, width);
}
