// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import uPlot from "uplot";
import { element } from "../ui/dom.ts";
import { faded } from "../ui/palette.ts";
import { onTheme, themeColour } from "../ui/theme.ts";

export type Values = (number | null)[];

export interface ChartSeries {
  label: string;
  values: Values;
  /** Default: the colour of the text. */
  colour?: string;
  kind?: "line" | "dots" | "points" | "both" | "dashed" | "shade" | "band";
  /** Lower edge of a band; `values` is the upper edge. */
  lower?: Values;
}

export interface ChartSettings {
  title: string;
  x: ArrayLike<number>;
  xLabel?: string;
  series: ChartSeries[];
  height?: number;
  range?: [number, number];
  xLog?: boolean;
  yLog?: boolean;
  /** Called with the x at which the reader pressed. */
  seek?: (x: number) => void;
  /** Paints in place of the series, in the coordinates of the canvas. */
  paint?: (plot: uPlot) => void;
  yNames?: string[];
  /** Names of x = 1, 2, ... */
  xNames?: string[];
}

const WIDTHS: Partial<Record<string, number>> = { dots: 0, shade: 0.6, band: 0.6, dashed: 1.1 };

function stroke(series: ChartSeries): () => string {
  return () => series.colour ?? themeColour("--ink");
}

/** Small squares; only one is painted per place, so that many thousand are cheap. */
function paintDots(plot: uPlot, index: number, colour: string): void {
  const { ctx, bbox } = plot;
  const [xs, ys] = [plot.data[0], plot.data[index]];
  const size = Math.round(2.4 * devicePixelRatio);
  const taken = new Set<number>();
  const top = Math.round(bbox.top);
  const bottom = top + Math.round(bbox.height);
  ctx.save();
  ctx.fillStyle = colour;
  for (let i = 0; i < xs.length; ++i) {
    const value = ys[i];
    if (value === null || value === undefined) continue;
    const x = Math.round(plot.valToPos(xs[i], "x", true));
    const y = Math.round(plot.valToPos(value, "y", true));
    if (x < bbox.left || x > bbox.left + bbox.width || y < top || y > bottom) continue;
    const place = x * 16384 + y;
    if (taken.has(place)) continue;
    taken.add(place);
    ctx.fillRect(x - size / 2, y - size / 2, size, size);
  }
  ctx.restore();
}

function seriesOf(series: ChartSeries): uPlot.Series {
  const colour = stroke(series);
  const kind = series.kind ?? "line";
  return {
    label: series.label,
    stroke: kind === "shade" || kind === "band" ? () => faded7(colour(), 0.5) : colour,
    width: WIDTHS[kind] ?? 1.6,
    ...(kind === "dots" ? { paths: (plot, index) => (paintDots(plot, index, colour()), null) } : {}),
    ...(kind === "dashed" ? { dash: [6, 4] } : {}),
    ...(kind === "shade" ? { fill: () => faded7(colour(), 0.16) } : {}),
    ...(kind === "points" ? { paths: () => null } : {}),
    points: { show: kind === "both" || kind === "points", size: 6, stroke: colour, fill: colour, width: 0.5 },
    value: (_plot, value) => (value === null || value === undefined ? "–" : String(Number(value.toPrecision(4)))),
    spanGaps: false,
  };
}

const faded7 = (colour: string, opacity: number) => (colour.length === 7 ? faded(colour, opacity) : colour);

/** The legend's text for the position of the pointer. */
function xSeries({ xLabel, xNames }: ChartSettings): uPlot.Series {
  const text = (value: number | null) => (value === null ? "–" : (xNames?.[value - 1] ?? String(Number(value.toPrecision(6)))));
  return { label: xLabel ?? (xNames ? "at" : "time [s]"), value: (_plot, value) => text(value) };
}

function namedTicks(names: string[]): uPlot.Axis {
  const longest = Math.max(...names.map((name) => name.length));
  return { size: Math.min(150, 14 + 6.5 * longest), rotate: -90, splits: () => names.map((_, i) => i + 1), values: () => names };
}

/** A plot with a caption, a legend, and a line that marks a value on its x axis. */
export class Chart {
  readonly node: HTMLElement;
  private readonly plot: uPlot;
  private readonly mark = element("div", { class: "playhead" });
  private readonly place: HTMLElement;

  constructor(private readonly settings: ChartSettings) {
    this.place = element("div", { class: "plot", role: "img", "aria-label": this.summary() });
    this.node = element("figure", { class: "chart" }, element("figcaption", {}, settings.title), this.place);
    const data: Values[] = [Array.from(settings.x)];
    const series: uPlot.Series[] = [xSeries(settings)];
    const bands: uPlot.Band[] = [];
    for (const one of settings.series) {
      data.push(one.values);
      series.push(seriesOf(one));
      if (one.kind === "band" && one.lower) {
        data.push(one.lower);
        series.push({ ...seriesOf(one), label: `${one.label} (lower)` });
        bands.push({ series: [data.length - 2, data.length - 1], fill: () => faded7(stroke(one)(), 0.16) });
      }
    }
    this.plot = new uPlot(this.options(series, bands), data as uPlot.AlignedData, this.place);
    this.plot.over.append(this.mark);
    this.listen();
  }

  private options(series: uPlot.Series[], bands: uPlot.Band[]): uPlot.Options {
    const { settings } = this;
    const axis = (extra: uPlot.Axis): uPlot.Axis => ({
      stroke: () => themeColour("--muted"),
      grid: { stroke: () => themeColour("--line"), width: 1 },
      ticks: { stroke: () => themeColour("--line"), width: 1, size: 4 },
      font: "11px system-ui, sans-serif",
      labelFont: "11px system-ui, sans-serif",
      ...extra,
    });
    const names = settings.yNames;
    return {
      width: 320,
      height: settings.height ?? 170,
      series,
      bands,
      scales: {
        x: {
          time: false, distr: settings.xLog ? 3 : 1,
          ...(settings.xNames ? { range: [0.5, settings.xNames.length + 0.5] as [number, number] } : {}),
        },
        y: { distr: settings.yLog ? 3 : 1, ...(settings.range ? { range: settings.range } : {}) },
      },
      axes: [
        axis({
          size: 24, gap: 3, ...(settings.xNames ? namedTicks(settings.xNames) : {}), ...(settings.xLabel ? { label: settings.xLabel, labelSize: 16, labelGap: 0 } : {}),
        }),
        axis({ size: names ? 84 : 54, gap: 3, ...(names ? { splits: () => names.map((_, i) => i + 0.5), values: () => names } : {}) }),
      ],
      cursor: { drag: { x: true, y: false }, points: { size: 5 }, ...(settings.seek ? { sync: { key: "time" } } : {}) },
      legend: { show: settings.series.length > 0 && !settings.paint },
      hooks: settings.paint ? { draw: [settings.paint] } : {},
      padding: [6, 8, 0, 0],
    };
  }

  private listen(): void {
    const { over } = this.plot;
    let pressed = NaN;
    over.addEventListener("mousedown", (event) => (pressed = event.clientX));
    over.addEventListener("click", (event) => {
      if (Math.abs(event.clientX - pressed) > 3) return;
      this.settings.seek?.(this.plot.posToVal(event.clientX - over.getBoundingClientRect().left, "x"));
    });
    new ResizeObserver(() => {
      const width = this.place.clientWidth;
      if (width > 0 && width !== this.plot.width) this.plot.setSize({ width, height: this.settings.height ?? 170 });
      this.setMark(this.at);
    }).observe(this.place);
    onTheme(() => this.plot.redraw(false));
    this.plot.hooks.setScale = [() => this.setMark(this.at)];
  }

  private summary(): string {
    const { title, series, x } = this.settings;
    return `Plot of ${title}: ${series.map(({ label }) => label).join(", ")}; ${x.length} points.`;
  }

  private at = NaN;

  /** Moves the line to a value of x. */
  setMark(x: number): void {
    this.at = x;
    const { min, max } = this.plot.scales["x"];
    const inside = min != null && max != null && x >= min && x <= max;
    this.mark.style.display = inside ? "" : "none";
    if (inside) this.mark.style.transform = `translateX(${this.plot.valToPos(x, "x").toFixed(1)}px)`;
  }

  destroy(): void {
    this.plot.destroy();
  }
}
