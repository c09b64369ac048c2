// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A small line over the whole run, with a limit and the shown frame.
import type { RunState } from "../state/run_state.ts";
import { element } from "./dom.ts";
import { svgElement } from "./icons.ts";

const POINTS = 150;
const HEIGHT = 30;

export interface SparkSeries {
  label: string;
  /** NaN where there is nothing. */
  at: (frame: number) => number;
  top: number;
  /** A dotted line. */
  limit?: number;
}

export interface Sparkline {
  node: HTMLElement;
  mark: () => void;
}

/** The largest value of every group of successive frames, as the points of a path with gaps. */
export function sparkPath({ at, top }: SparkSeries, frames: number): string {
  const count = Math.min(POINTS, frames);
  let path = "";
  let pen = false;
  for (let i = 0; i < count; ++i) {
    let largest = NaN;
    for (let frame = Math.floor((i * frames) / count); frame < Math.floor(((i + 1) * frames) / count); ++frame) {
      const value = at(frame);
      if (!(value <= largest)) largest = Number.isNaN(value) ? largest : value;
    }
    if (Number.isNaN(largest)) {
      pen = false;
      continue;
    }
    const y = HEIGHT - (HEIGHT - 1) * Math.max(0, Math.min(1, largest / top));
    path += `${pen ? "L" : "M"}${((i * POINTS) / count).toFixed(1)} ${y.toFixed(1)}${pen ? "" : "h.01"}`;
    pen = true;
  }
  return path;
}

export function sparkline(state: RunState, series: SparkSeries, colour: string): Sparkline {
  const { frames } = state.trace;
  const svg = svgElement("svg", { viewBox: `0 0 ${POINTS} ${HEIGHT}`, preserveAspectRatio: "none", "aria-hidden": "true" });
  const line = (d: string, stroke: string, extra: Record<string, string | number>) =>
    svg.append(svgElement("path", { d, stroke, fill: "none", "vector-effect": "non-scaling-stroke", ...extra }));
  if (series.limit !== undefined) {
    line(`M0 ${(HEIGHT - (HEIGHT - 1) * (series.limit / series.top)).toFixed(1)}H${POINTS}`, "var(--muted)", { "stroke-dasharray": "2 3" });
  }
  line(sparkPath(series, frames), colour, { "stroke-width": 1.3, "stroke-linejoin": "round" });
  const playhead = element("span", { class: "playhead" });
  const plot = element("div", { class: "spark", title: "Press to go there" });
  plot.append(svg, playhead);
  plot.addEventListener("click", (event) => {
    const box = plot.getBoundingClientRect();
    state.go(((event.clientX - box.left) / box.width) * (frames - 1));
  });
  const mark = () => (playhead.style.left = `${((100 * state.frame) / Math.max(1, frames - 1)).toFixed(2)}%`);
  mark();
  return { node: element("figure", { class: "sparkline" }, plot, element("figcaption", {}, series.label)), mark };
}
