// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A chart as an SVG document: its series over the part that is shown, with title, legend and axes.
import { themeColour } from "../ui/theme.ts";
import type { Chart, ChartSeries, ChartSettings } from "./chart.ts";
import { faded7, isLine, SHADE, xLabelOf } from "./chart_options.ts";
import { paintCarets, paintDots } from "./marks.ts";
import { type Field, SvgPen } from "./pen.ts";
import { type Points, polylines, wrapped } from "./polyline.ts";
import { logTicks, short, ticks } from "./ticks.ts";

const WIDTH = 640;
const LEFT = 64;
const NAMED_LEFT = 110;
const RIGHT = 14;
const LINE = 17;

/** The area between two lines that have their gaps at the same places. */
function area(upper: Points[], lower: Points[]): Points[] {
  return upper.map((line, k) => {
    const back = lower[k] ?? [];
    const points = [...line];
    for (let i = back.length - 2; i >= 0; i -= 2) points.push(back[i], back[i + 1]);
    return points;
  });
}

function drawSeries(pen: SvgPen, field: Field, x: ArrayLike<number>, series: ChartSeries, colour: string, floor: number): void {
  const kind = series.kind ?? "line";
  const lines = polylines(x, series.values, field);
  if (kind === "dots" || kind === "points" || kind === "both") paintDots(pen, field, x, { ...series, size: kind === "dots" ? (series.size ?? 2.4) : 6 }, colour);
  if (kind === "dots" || kind === "points") return;
  if (kind === "shade" || kind === "band") {
    const lower = series.lower ? polylines(x, series.lower, field) : lines.map((line) => [line[0], floor, line[line.length - 2], floor]);
    for (const shape of area(lines, lower)) pen.shape(shape, faded7(colour, SHADE));
    for (const line of series.lower ? [...lines, ...lower] : lines) pen.line(line, faded7(colour, 0.45), 0.6);
    return;
  }
  for (const line of lines) pen.line(line, colour, kind === "dashed" ? 1.2 : 1.6, kind === "dashed" ? [6, 4] : []);
}

interface Key {
  label: string;
  colour: string;
  kind: ChartSeries["kind"] | "painted";
}

function keysOf(chart: Chart): Key[] {
  const { paint, keys, series } = chart.settings;
  if (paint) return (keys ?? []).map((key) => ({ ...key, kind: "painted" }));
  return series.flatMap(({ label, kind }, k) => (chart.isShown(k) ? [{ label, kind, colour: chart.colourOf(k) }] : []));
}

/** Draws the entries in rows; returns how many rows there are. */
function drawLegend(pen: SvgPen, keys: readonly Key[], x: number, y: number): number {
  let at = x;
  let row = y;
  for (const { label, kind, colour } of keys) {
    const width = 26 + pen.widthOf(label);
    if (at + width > WIDTH - RIGHT && at > x) [at, row] = [x, row + LINE];
    if (kind === "painted") pen.rect(at, row - 5, 14, 10, colour);
    else if (kind === "shade" || kind === "band") pen.rect(at, row - 4, 14, 8, faded7(colour, 0.4));
    else if (kind === "dots" || kind === "points") pen.rect(at + 5, row - 2, 4, 4, colour);
    else pen.line([at, row, at + 14, row], colour, 2, kind === "dashed" ? [4, 3] : []);
    pen.text(label, at + 19, row, themeColour("--ink"));
    at += width + 12;
  }
  return keys.length === 0 ? 0 : 1 + (row - y) / LINE;
}

function drawAxes(pen: SvgPen, field: Field, settings: ChartSettings, y: [number, number]): void {
  const [muted, line] = [themeColour("--muted"), themeColour("--line")];
  const { left, top, width, height } = field;
  const bottom = top + height;
  const names = settings.xNames;
  const xs = names ? names.map((_, i) => i + 1) : settings.xLog ? logTicks(...field.range, 8) : ticks(...field.range, 8);
  for (const value of xs) {
    const x = field.x(value);
    pen.line([x, top, x, bottom], line, 1);
    if (names) pen.text(names[value - 1], x, bottom + 8, muted, { align: "end", turn: -50 });
    else pen.text(short(value, 6), x, bottom + 11, muted, { align: "middle" });
  }
  if (settings.yNames) settings.yNames.forEach((name, i) => pen.text(name, left - 8, field.y(i + 0.5), muted, { align: "end" }));
  else {
    for (const value of settings.yTicks ?? (settings.yLog ? logTicks(...y, 6) : ticks(...y, 6))) {
      pen.line([left, field.y(value), left + width, field.y(value)], line, 1);
      pen.text(short(value), left - 8, field.y(value), muted, { align: "end" });
    }
  }
  pen.line([left, top, left, bottom, left + width, bottom], muted, 1);
}

function scale(range: [number, number], log: boolean, from: number, to: number): (value: number) => number {
  const turn = log ? Math.log10 : (value: number) => value;
  const [low, high] = [turn(range[0]), turn(range[1])];
  return (value) => from + ((turn(value) - low) / (high - low || 1)) * (to - from);
}

function fieldOfFigure(chart: Chart, top: number, height: number): { field: Field; y: [number, number] } {
  const { settings, plot } = chart;
  const [sx, sy] = [plot.scales["x"], plot.scales["y"]];
  const range: [number, number] = [sx.min ?? 0, sx.max ?? 1];
  const y: [number, number] = [sy.min ?? 0, sy.max ?? 1];
  const left = settings.yNames ? NAMED_LEFT : LEFT;
  const width = WIDTH - left - RIGHT;
  const field: Field = {
    left, top, width, height, pixel: 1, range,
    x: scale(range, settings.xLog === true, left, left + width), y: scale(y, settings.yLog === true, top + height, top),
  };
  return { field, y };
}

/** The SVG text of a chart as it is shown, in the colours of now. */
export function figureOf(chart: Chart): string {
  const { settings } = chart;
  const pen = new SvgPen();
  const left = settings.yNames ? NAMED_LEFT : LEFT;
  const notes = settings.note ? wrapped(settings.note, WIDTH - RIGHT - left, (text) => pen.widthOf(text)) : [];
  const legendTop = 34 + LINE * notes.length;
  const wraps = drawLegend(new SvgPen(), keysOf(chart), left, legendTop);
  const top = 32 + LINE * (wraps + notes.length);
  const height = Math.max(160, (settings.height ?? 170) * 1.2);
  const below = (settings.xNames ? 20 + 5 * Math.max(...settings.xNames.map((name) => name.length)) : 24) + (xLabelOf(settings) ? 20 : 4);
  const whole = top + height + below;
  const { field, y } = fieldOfFigure(chart, top, height);
  pen.rect(0, 0, WIDTH, whole, themeColour("--paper"));
  pen.text(settings.title, field.left, 16, themeColour("--ink"), { size: 14, bold: true });
  notes.forEach((line, i) => pen.text(line, field.left, 33 + LINE * i, themeColour("--muted")));
  drawLegend(pen, keysOf(chart), field.left, legendTop);
  drawAxes(pen, field, settings, y);
  pen.clip(field.left, field.top, field.width, field.height, () => {
    if (settings.paint) return settings.paint(pen, field);
    settings.series.forEach((series, k) => {
      if (chart.isShown(k)) drawSeries(pen, field, settings.x, series, chart.colourOf(k), field.top + field.height);
    });
    settings.series.forEach((series, k) => {
      if (chart.isShown(k) && isLine(series) && !series.quiet) paintCarets(pen, field, settings.x, series.values, y, chart.colourOf(k));
    });
  });
  if (xLabelOf(settings)) pen.text(xLabelOf(settings), field.left + field.width / 2, whole - 9, themeColour("--muted"), { align: "middle" });
  return pen.document(WIDTH, whole, settings.title);
}
