// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The legend of a group of charts: one entry per series, which shows and hides it; the part of the time that is shown.
import { button, element } from "../ui/dom.ts";
import type { Chart } from "./chart.ts";
import { short } from "./ticks.ts";
import { timeWindow } from "./window.ts";

interface Entry {
  button: HTMLButtonElement;
  key: HTMLElement;
  value: HTMLElement;
  chart: Chart;
  place: number;
}

export class Legend {
  private readonly when = element("span", { class: "when" });
  private readonly entries = element("div", { class: "entries", role: "group", "aria-label": "Series" });
  private readonly hint = element("span", { class: "hint" });
  private readonly zooms = element("div", { class: "zooms", role: "group", "aria-label": "Shown time" });
  readonly node = element("div", { class: "plot-legend" }, this.entries, this.when, this.hint, this.zooms);
  private readonly reset = button("Reset zoom", () => timeWindow.set(undefined));
  private made: Entry[] = [];
  private charts: Chart[] = [];
  /** Names of series that the reader has hidden; they stay hidden for another object. */
  private readonly hidden = new Set<string>();

  constructor(private readonly seconds: () => number) {
    this.zooms.append(
      button("−", () => this.zoom(2), { "aria-label": "Zoom out", title: "Zoom out" }),
      button("+", () => this.zoom(0.5), { "aria-label": "Zoom in", title: "Zoom in, about the playhead" }));
  }

  private zoom(factor: number): void {
    const timed = this.charts.find((chart) => chart.isTime);
    if (timed) timeWindow.zoom(factor, this.seconds(), timed.whole);
  }

  fill(charts: Chart[]): void {
    this.charts = charts;
    const names = new Map<string, { chart: Chart; place: number }>();
    for (const chart of charts) {
      if (chart.settings.paint) continue;
      chart.settings.series.forEach(({ label }, place) => names.has(label) || names.set(label, { chart, place }));
    }
    const plain = charts.filter((chart) => !chart.settings.paint);
    const uses = (label: string) => plain.filter((chart) => chart.settings.series.some((series) => series.label === label)).length;
    // Values stand in the legend where that is unique, else in the captions.
    for (const chart of plain) chart.readAbove = chart.settings.series.every(({ label }) => uses(label) === 1);
    this.made = [...names].map(([label, { chart, place }]) => this.entry(label, chart, place));
    this.entries.replaceChildren(...this.made.map(({ button: made }) => made));
    // A single line is named by its title.
    this.entries.hidden = this.made.length === 0 || (this.made.length === 1 && plain.length > 1);
    this.zooms.hidden = !charts.some((chart) => chart.isTime);
    this.node.hidden = charts.length === 0;
    for (const label of this.hidden) for (const chart of charts) chart.setShown(label, false);
    this.paint();
    this.write();
  }

  private entry(label: string, chart: Chart, place: number): Entry {
    const kind = chart.settings.series[place].kind ?? "line";
    const key = element("span", { class: `key ${kind}` });
    const value = element("span", { class: "value" });
    const made = button("", () => {
      const on = this.hidden.has(label);
      if (on) this.hidden.delete(label);
      else this.hidden.add(label);
      for (const one of this.charts) one.setShown(label, on);
      made.setAttribute("aria-pressed", String(on));
      this.write();
    }, { class: "entry", "aria-pressed": String(!this.hidden.has(label)), title: `Show or hide ${label}` });
    made.append(key, label, value);
    return { button: made, key, value, chart, place };
  }

  /** Takes the colours of now. */
  paint(): void {
    for (const { key, chart, place } of this.made) key.style.setProperty("--swatch", chart.colourOf(place));
  }

  /** The values at the pointer or the playhead, and whether a part of the time is shown. */
  write(): void {
    const set = (node: HTMLElement, text: string) => node.textContent === text || (node.textContent = text);
    const first = this.charts.find((chart) => !chart.settings.paint);
    for (const { value, chart, place } of this.made) set(value, chart.readAbove && chart.isShown(place) ? chart.valueOf(place) : "");
    const read = first?.isTime ? first.read : undefined;
    set(this.when, read?.x === undefined ? "" : `${read.byPointer ? "pointer" : "playhead"} at ${read.x.toFixed(2)} s`);
    const range = timeWindow.range;
    const seconds = this.seconds();
    const off = range !== undefined && (seconds < range[0] || seconds > range[1]);
    if (range === undefined) this.reset.remove();
    else if (!this.reset.isConnected) this.zooms.append(this.reset);
    set(this.hint, off ? `The playhead, at ${short(seconds)} s, is out of view.` : "");
  }
}
