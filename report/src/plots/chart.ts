// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import uPlot from "uplot";
import { element } from "../ui/dom.ts";
import { colourOfSeries, optionsOf, prepare } from "./chart_options.ts";
import type { Painter } from "./pen.ts";
import { saveMenu } from "./save.ts";
import { placeOf, short } from "./ticks.ts";
import { type Range, timeWindow } from "./window.ts";

export type Values = (number | null)[];

export interface ChartSeries {
  label: string;
  values: Values;
  /** Default: the colour of the text. */
  colour?: string;
  kind?: "line" | "dots" | "points" | "both" | "dashed" | "shade" | "band";
  /** Lower edge of a band; `values` is the upper edge. */
  lower?: Values;
  /** Of dots, in pixels. */
  size?: number;
  /** Whether its values are not read out. */
  quiet?: boolean;
  /** Called when the reader presses on the line. */
  select?: () => void;
}

export interface Rows {
  columns: string[];
  rows: (number | string | null)[][];
}

export interface ChartSettings {
  title: string;
  x: ArrayLike<number>;
  xLabel?: string;
  series: ChartSeries[];
  /** A sentence below the title. */
  note?: string;
  height?: number;
  range?: [number, number];
  xLog?: boolean;
  yLog?: boolean;
  /** Called with the x at which the reader pressed. */
  seek?: (x: number) => void;
  /** Called with the row at which the reader pressed, of a chart with `yNames`, from the top. */
  pressRow?: (row: number) => void;
  /** Paints in place of the series. */
  paint?: Painter;
  /** What the colours of a painted chart mean, for export. */
  keys?: { label: string; colour: string }[];
  /** What is painted, for export. */
  rows?: () => Rows;
  yNames?: string[];
  /** Where the y axis has its ticks. */
  yTicks?: number[];
  /** Names of x = 1, 2, ... */
  xNames?: string[];
}

const NEAR = 8;
const WIDE_PAGE = 2400;

/** A plot with a caption, the values at the pointer or at the shown time, and a line there. */
export class Chart {
  readonly node: HTMLElement;
  readonly plot: uPlot;
  /** Whether the group's legend has the values. */
  private valuesAbove = false;
  private readonly mark = element("div", { class: "playhead" });
  private readonly off = element("span", { class: "off", hidden: true });
  private readonly place = element("div", { class: "plot" });
  private readonly readout = element("p", { class: "readout" });
  private readonly beyond = element("p", { class: "beyond" });
  private readonly places: number[][];
  private readonly hidden = new Set<number>();
  private readonly observer: ResizeObserver;
  private at = NaN;
  /** Told when the pointer is at another place. */
  pointed: () => void = () => {};

  constructor(readonly settings: ChartSettings) {
    const { title, note } = settings;
    const caption = element("figcaption", {}, title);
    this.node = element("figure", { class: "chart" }, caption, saveMenu(this), this.readout,
      ...(note ? [element("p", { class: "note" }, note)] : []), this.beyond, this.place);
    const prepared = prepare(settings);
    this.places = prepared.places;
    const events = {
      zoomed: (range: Range) => this.zoomTo(range),
      reset: () => this.zoomTo(undefined),
      scaled: () => this.setMark(this.at),
      pointed: () => (this.write(), this.pointed()),
      beyond: (text: string) => this.setText(this.beyond, text),
      shown: (k: number) => !this.hidden.has(k),
    };
    this.plot = new uPlot(optionsOf(settings, this.height, prepared, events), prepared.data, this.place);
    const canvas = this.plot.root.querySelector("canvas")!;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", this.summary());
    this.plot.over.append(this.mark, this.off);
    for (const { label, quiet } of settings.series) this.readout.append(element("span", { "data-label": label, hidden: quiet === true }));
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(this.place);
    this.listen();
  }

  private get height(): number {
    return Math.round((this.settings.height ?? 170) * (innerWidth >= WIDE_PAGE ? 1.4 : 1));
  }

  private resize(): void {
    const width = this.place.clientWidth;
    if (width > 0 && (width !== this.plot.width || this.height !== this.plot.height)) this.plot.setSize({ width, height: this.height });
    this.setMark(this.at);
  }

  private listen(): void {
    const { over } = this.plot;
    let pressed = NaN;
    over.addEventListener("mousedown", (event) => (pressed = event.clientX));
    over.addEventListener("click", (event) => {
      if (Math.abs(event.clientX - pressed) > 3) return;
      const box = over.getBoundingClientRect();
      const [x, y] = [event.clientX - box.left, event.clientY - box.top];
      this.settings.seek?.(this.plot.posToVal(x, "x"));
      const { yNames, pressRow } = this.settings;
      if (yNames && pressRow) pressRow(Math.max(0, Math.min(yNames.length - 1, Math.floor((y / box.height) * yNames.length))));
      else this.lineAt(x, y)?.select?.();
    });
  }

  /** The series whose line is at a place. */
  private lineAt(x: number, y: number): ChartSeries | undefined {
    const index = this.plot.posToIdx(x);
    let best: ChartSeries | undefined;
    let least = NEAR;
    this.settings.series.forEach((series, k) => {
      const value = series.values[index];
      if (!series.select || this.hidden.has(k) || value === null || value === undefined) return;
      const distance = Math.abs(this.plot.valToPos(value, "y") - y);
      if (distance < least) [best, least] = [series, distance];
    });
    return best;
  }

  private summary(): string {
    const { title, series, x, note } = this.settings;
    return `Plot of ${title}: ${series.map(({ label }) => label).join(", ")}; ${x.length} points.${note ? ` ${note}` : ""}`;
  }

  /** Whether its x is the time of the run. */
  get isTime(): boolean {
    return this.settings.seek !== undefined;
  }

  get whole(): Range {
    const { x } = this.settings;
    return [x[0] ?? 0, x[x.length - 1] ?? 1];
  }

  private zoomTo(range: Range | undefined): void {
    if (this.isTime) timeWindow.set(range);
    else this.show(range);
  }

  /** Shows a part of x, or all. */
  show(range: Range | undefined): void {
    const [min, max] = range ?? this.whole;
    const now = this.plot.scales["x"];
    if (now.min === min && now.max === max) return;
    if (range || !this.settings.xNames) this.plot.setScale("x", { min, max });
  }

  private setText(node: HTMLElement, text: string): void {
    if (node.textContent !== text) node.textContent = text;
  }

  /** The value of a series at the pointer, else at the line; "" if there is none. */
  valueOf(k: number): string {
    const index = this.index();
    const series = this.settings.series[k];
    const value = index === undefined ? undefined : series.values[index];
    if (value === null || value === undefined) return index === undefined ? "" : "–";
    return (series.kind === "band" && series.lower ? "± " : "") + short(value);
  }

  private index(): number | undefined {
    const { idx } = this.plot.cursor;
    if (idx !== null && idx !== undefined && (this.plot.cursor.left ?? -1) >= 0) return idx;
    return Number.isNaN(this.at) ? undefined : placeOf(this.settings.x, this.at);
  }

  /** The x of the values, and whether the pointer chose it. */
  get read(): { x: number | undefined; byPointer: boolean } {
    const index = this.index();
    const byPointer = (this.plot.cursor.left ?? -1) >= 0;
    return { x: index === undefined ? undefined : this.settings.x[index], byPointer };
  }

  get readAbove(): boolean {
    return this.valuesAbove;
  }

  set readAbove(above: boolean) {
    this.valuesAbove = above;
    this.readout.hidden = above || this.settings.paint !== undefined;
  }

  private write(): void {
    if (this.valuesAbove || this.settings.paint) return;
    this.settings.series.forEach(({ label, quiet }, k) => {
      if (quiet) return;
      const value = this.valueOf(k);
      this.setText(this.readout.children[k] as HTMLElement, value === "" || this.hidden.has(k) ? "" : `${label} ${value}`);
    });
  }

  /** Shows or hides the series of a name. */
  setShown(label: string, on: boolean): void {
    this.settings.series.forEach((series, k) => {
      if (series.label !== label || on !== this.hidden.has(k)) return;
      if (on) this.hidden.delete(k);
      else this.hidden.add(k);
      for (const place of this.places[k]) this.plot.setSeries(place, { show: on });
    });
    this.write();
  }

  isShown(k: number): boolean {
    return !this.hidden.has(k);
  }

  /** Moves the line to a value of x. */
  setMark(x: number): void {
    this.at = x;
    const { min, max } = this.plot.scales["x"];
    const known = min != null && max != null && !Number.isNaN(x);
    const inside = known && x >= min && x <= max;
    this.mark.style.display = inside ? "" : "none";
    if (inside) this.mark.style.transform = `translateX(${this.plot.valToPos(x, "x").toFixed(1)}px)`;
    this.off.hidden = !known || inside;
    if (known && !inside) {
      this.off.className = x < min ? "off before" : "off after";
      this.setText(this.off, x < min ? `◂ ${short(x)}` : `${short(x)} ▸`);
    }
    this.write();
  }

  /** Paints it anew, in the colours of now. */
  redraw(): void {
    this.plot.redraw(false);
  }

  colourOf(k: number): string {
    return colourOfSeries(this.settings.series[k]);
  }

  destroy(): void {
    this.observer.disconnect();
    this.plot.destroy();
  }
}
