// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { element } from "../ui/dom.ts";
import type { Chart } from "./chart.ts";

/** Charts that share the line at the shown time; only visible charts are updated. */
export class ChartGroup {
  readonly node = element("div", { class: "charts" });
  private charts: Chart[] = [];
  private seconds = NaN;

  replace(charts: Chart[]): void {
    for (const chart of this.charts) chart.destroy();
    this.charts = charts;
    this.node.replaceChildren(...charts.map(({ node }) => node));
    this.mark();
  }

  /** Moves the line. */
  update(seconds: number): void {
    this.seconds = seconds;
    this.mark();
  }

  mark(): void {
    if (this.node.closest("[hidden]")) return;
    for (const chart of this.charts) chart.setMark(this.seconds);
  }
}
