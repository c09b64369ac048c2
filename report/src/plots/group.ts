// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { element } from "../ui/dom.ts";
import { onTheme } from "../ui/theme.ts";
import type { Chart } from "./chart.ts";
import { Legend } from "./legend.ts";
import { timeWindow } from "./window.ts";

/** Charts that share a legend, the line at the shown time and the part of the time; only visible charts are updated. */
export class ChartGroup {
  private readonly legend = new Legend(() => this.seconds);
  private readonly grid = element("div", { class: "charts" });
  readonly node = element("div", { class: "chart-group" }, this.legend.node, this.grid);
  private charts: Chart[] = [];
  private seconds = NaN;

  constructor() {
    timeWindow.onChange(() => this.mark());
    onTheme(() => {
      for (const chart of this.charts) chart.redraw();
      this.legend.paint();
    });
  }

  replace(charts: Chart[]): void {
    for (const chart of this.charts) chart.destroy();
    this.charts = charts;
    this.grid.replaceChildren(...charts.map(({ node }) => node));
    this.legend.fill(charts);
    for (const chart of charts) chart.pointed = () => this.legend.write();
    this.mark();
  }

  /** Moves the line. */
  update(seconds: number): void {
    this.seconds = seconds;
    this.mark();
  }

  mark(): void {
    if (this.node.closest("[hidden]")) return;
    for (const chart of this.charts) {
      if (!chart.isTime) continue;
      chart.show(timeWindow.range);
      chart.setMark(this.seconds);
    }
    this.legend.write();
  }

  /** Paints all anew, as after a change of the selection. */
  redraw(): void {
    for (const chart of this.charts) chart.redraw();
  }
}
