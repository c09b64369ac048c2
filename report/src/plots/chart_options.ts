// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The settings of uPlot for a chart.
import uPlot from "uplot";
import { faded } from "../ui/palette.ts";
import { enlarged } from "../ui/text_size.ts";
import { themeColour } from "../ui/theme.ts";
import type { ChartSeries, ChartSettings } from "./chart.ts";
import { beyondText, countBeyond, paintCarets, paintDots } from "./marks.ts";
import { CanvasPen, type Field } from "./pen.ts";

const WIDTHS: Partial<Record<string, number>> = { dots: 0, shade: 0.6, band: 0.6, dashed: 1.2 };

export const faded7 = (colour: string, opacity: number) => (colour.length === 7 ? faded(colour, opacity) : colour);
export const colourOfSeries = (series: ChartSeries): string => series.colour ?? themeColour("--ink");
/** Values that should lie within the picture, so that those beyond it are marked. */
export const isLine = ({ kind }: ChartSeries) => kind === undefined || kind === "line" || kind === "both";

/** How dense an area is; areas may lie on one another. */
export const SHADE = 0.14;

export function fieldOf(plot: uPlot): Field {
  const { left, top, width, height } = plot.bbox;
  const { min, max } = plot.scales["x"];
  return {
    left, top, width, height, pixel: devicePixelRatio, range: [min ?? 0, max ?? 1],
    x: (value) => plot.valToPos(value, "x", true), y: (value) => plot.valToPos(value, "y", true),
  };
}

export const penOf = (plot: uPlot) => new CanvasPen(plot.ctx, devicePixelRatio);

function seriesOf(series: ChartSeries): uPlot.Series {
  const colour = () => colourOfSeries(series);
  const kind = series.kind ?? "line";
  const area = kind === "shade" || kind === "band";
  return {
    label: series.label,
    stroke: area ? () => faded7(colour(), 0.45) : colour,
    width: WIDTHS[kind] ?? 1.6,
    ...(kind === "dots" ? { paths: (plot) => (paintDots(penOf(plot), fieldOf(plot), plot.data[0], series, colour()), null) } : {}),
    ...(kind === "dashed" ? { dash: [6, 4] } : {}),
    ...(kind === "shade" ? { fill: () => faded7(colour(), SHADE) } : {}),
    ...(kind === "points" ? { paths: () => null } : {}),
    points: { show: kind === "both" || kind === "points", size: 6, stroke: colour, fill: colour, width: 0.5 },
    spanGaps: false,
  };
}

export interface Prepared {
  data: uPlot.AlignedData;
  series: uPlot.Series[];
  bands: uPlot.Band[];
  /** Of every series of the chart, its places among those of uPlot. */
  places: number[][];
}

/** A band is two series of uPlot. */
export function prepare({ x, series }: ChartSettings): Prepared {
  const data: ChartSeries["values"][] = [Array.from(x)];
  const made: uPlot.Series[] = [{}];
  const bands: uPlot.Band[] = [];
  const places = series.map((one) => {
    data.push(one.values);
    made.push(seriesOf(one));
    if (one.kind !== "band" || !one.lower) return [data.length - 1];
    data.push(one.lower);
    made.push(seriesOf(one));
    bands.push({ series: [data.length - 2, data.length - 1], fill: () => faded7(colourOfSeries(one), SHADE) });
    return [data.length - 2, data.length - 1];
  });
  return { data: data as uPlot.AlignedData, series: made, bands, places };
}

function namedTicks(names: string[], factor: number): uPlot.Axis {
  const longest = Math.max(...names.map((name) => name.length));
  return { size: factor * Math.min(150, 14 + 6.5 * longest), rotate: -90, splits: () => names.map((_, i) => i + 1), values: () => names };
}

function axes(settings: ChartSettings): uPlot.Axis[] {
  const factor = enlarged();
  const font = `${Math.round(11 * factor)}px system-ui, sans-serif`;
  const axis = (extra: uPlot.Axis): uPlot.Axis => ({
    stroke: () => themeColour("--muted"),
    grid: { stroke: () => themeColour("--line"), width: 1 },
    ticks: { stroke: () => themeColour("--line"), width: 1, size: 4 },
    font,
    labelFont: font,
    ...extra,
  });
  const { xNames, yNames, yTicks } = settings;
  const label = xLabelOf(settings);
  return [
    axis({ size: 24 * factor, gap: 3, ...(xNames ? namedTicks(xNames, factor) : {}), ...(label ? { label, labelSize: 16 * factor, labelGap: 0 } : {}) }),
    axis({ size: (yNames ? 96 : 54) * factor, gap: 3, ...(yTicks ? { splits: () => yTicks } : {}), ...(yNames ? { splits: () => yNames.map((_, i) => i + 0.5), values: () => yNames, grid: { show: false }, ticks: { show: false } } : {}) }),
  ];
}

export function xLabelOf({ xLabel, xNames, seek }: ChartSettings): string {
  return xLabel ?? (xNames || !seek ? "" : "time [s]");
}

/** Carets for what is beyond the edges, and how much that is. */
function paintEdges(plot: uPlot, settings: ChartSettings, shown: (k: number) => boolean): string {
  const { min, max } = plot.scales["y"];
  if (min == null || max == null) return "";
  const field = fieldOf(plot);
  const texts = settings.series.map((series, k) => {
    if (!shown(k) || (!isLine(series) && series.kind !== "dots") || series.quiet) return "";
    const colour = colourOfSeries(series);
    if (isLine(series)) paintCarets(penOf(plot), field, plot.data[0], series.values, [min, max], colour);
    return beyondText(series.label, countBeyond(plot.data[0], series.values, field.range, [min, max]));
  });
  return texts.filter((text) => text !== "").join(", ");
}

export interface Events {
  /** The reader has marked a part of x. */
  zoomed: (range: [number, number]) => void;
  reset: () => void;
  /** Another part of x is shown. */
  scaled: () => void;
  /** The pointer is at another value, or has left. */
  pointed: () => void;
  /** What lies beyond the edges, in words. */
  beyond: (text: string) => void;
  shown: (k: number) => boolean;
}

function takeSelection(plot: uPlot, events: Events): void {
  const { left, width } = plot.select;
  if (width < 4) return;
  plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
  events.zoomed([plot.posToVal(left, "x"), plot.posToVal(left + width, "x")]);
}

export function optionsOf(settings: ChartSettings, height: number, { series, bands }: Prepared, events: Events): uPlot.Options {
  const only = (type: string) => type === "mousemove" || type === "mouseleave";
  const { paint } = settings;
  return {
    width: 320, height, series, bands,
    scales: {
      x: {
        time: false, distr: settings.xLog ? 3 : 1,
        ...(settings.xNames ? { range: [0.5, settings.xNames.length + 0.5] as [number, number] } : {}),
        // A single frame is no range.
        ...(settings.seek && settings.x.length < 2 ? { range: [0, 1] as [number, number] } : {}),
      },
      y: { distr: settings.yLog ? 3 : 1, ...(settings.range ? { range: settings.range } : {}) },
    },
    axes: axes(settings),
    cursor: {
      drag: { x: true, y: false, setScale: false }, points: { size: 5, show: !paint }, y: !paint,
      bind: { dblclick: () => () => (events.reset(), null) },
      ...(settings.seek ? { sync: { key: "time", setSeries: false, filters: { pub: only } } } : {}),
    },
    legend: { show: false },
    hooks: {
      draw: [(plot) => (paint ? paint(penOf(plot), fieldOf(plot)) : events.beyond(paintEdges(plot, settings, events.shown)))],
      setSelect: [(plot) => takeSelection(plot, events)],
      setCursor: [() => events.pointed()],
      setScale: [(_plot, key) => key === "x" && events.scaled()],
    },
    padding: [8, 10, 0, 0],
  };
}
