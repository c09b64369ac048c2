// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Draws the hypotheses of an object as a river: weights on one another, each hypothesis one band for as long as it lives.
import type { RunState } from "../state/run_state.ts";
import { themeColour } from "../ui/theme.ts";
import { Chart, type Rows } from "./chart.ts";
import { faded7 } from "./chart_options.ts";
import type { Field, Pen } from "./pen.ts";
import { bandsOf, type Part } from "./river_bands.ts";
import { laneAt, type River } from "./river.ts";
import { placeOf } from "./ticks.ts";

/** Above the weights there is a strip for births and ends. */
const TOP = 1.16;
const STRIP = 1.08;
const MARK = 3.5;
const LEAST_GAP = 6;

function paintPart(pen: Pen, { upper, lower }: Part, colour: string, pixel: number): void {
  // A hypothesis of a single column is a line.
  const points = upper.length > 2 ? [...upper] : [upper[0] - pixel, upper[1], upper[0] + pixel, upper[1]];
  const back = lower.length > 2 ? lower : [lower[0] - pixel, lower[1], lower[0] + pixel, lower[1]];
  for (let i = back.length - 2; i >= 0; i -= 2) points.push(back[i], back[i + 1]);
  pen.shape(points, colour);
}

/** A triangle for a birth, a diamond for a merge, a cross for one that was dropped. */
export function paintMark(pen: Pen, kind: "birth" | "merged" | "dropped", x: number, y: number, pixel: number, colour: string): void {
  const r = MARK * pixel;
  if (kind === "birth") pen.shape([x - r, y + r, x, y - r, x + r, y + r], colour);
  else if (kind === "merged") pen.shape([x - r, y, x, y - r, x + r, y, x, y + r], colour);
  else {
    pen.line([x - r, y - r, x + r, y + r], colour, 1.6 * pixel);
    pen.line([x - r, y + r, x + r, y - r], colour, 1.6 * pixel);
  }
}

function paintEvents(pen: Pen, field: Field, river: River, seconds: Float64Array, colour: (lane: number) => string): void {
  const last = { birth: -Infinity, end: -Infinity };
  const y = field.y(STRIP);
  const events = river.lanes.flatMap(({ first, last: end, end: how }, lane) => [
    ...(first > 0 ? [{ frame: first, kind: "birth" as const, row: "birth" as const, lane }] : []),
    ...(how !== "alive" ? [{ frame: end, kind: how, row: "end" as const, lane }] : []),
  ]);
  for (const { frame, kind, row, lane } of events.sort((a, b) => a.frame - b.frame)) {
    const x = field.x(seconds[frame]);
    if (x < field.left || x > field.left + field.width || x - last[row] < LEAST_GAP * field.pixel) continue;
    last[row] = x;
    paintMark(pen, kind, x, y + (row === "birth" ? 4 : -4) * field.pixel, field.pixel, colour(lane));
  }
}

function rowsOf(river: River, seconds: Float64Array): Rows {
  const rows: Rows["rows"] = [];
  for (let frame = 0; frame < river.frames; ++frame) {
    river.laneOf.forEach((list, k) => {
      if (list[frame] >= 0) rows.push([seconds[frame], river.lanes[list[frame]].id, river.slots[k].probability(frame)]);
    });
  }
  return { columns: ["time [s]", "hypothesis", "weight"], rows };
}

const MOST_KEYS = 10;

/** The lanes that were heaviest at their time, in the order of their births. */
function heaviest({ lanes }: River): number[] {
  return lanes.map((_, lane) => lane).sort((a, b) => lanes[b].peak - lanes[a].peak).slice(0, MOST_KEYS).sort((a, b) => a - b);
}

export interface RiverChart {
  chart: Chart;
  /** Highlights a lane; undefined: none. */
  highlight: (lane: number | undefined) => void;
}

/** The chart of a river; `pointed` is told the lane under the pointer. */
export function riverChart(state: RunState, title: string, river: River, colour: (lane: number) => string, pointed: (lane: number | undefined) => void): RiverChart {
  const { seconds } = state.trace;
  let shown: number | undefined;
  const paint = (pen: Pen, field: Field) => {
    const parts = bandsOf(river, seconds, field);
    for (const part of parts) paintPart(pen, part, faded7(colour(part.lane), shown === undefined || shown === part.lane ? 0.85 : 0.22), field.pixel);
    const edge = themeColour("--paper");
    for (const { upper } of parts) pen.line(upper, edge, 0.8 * field.pixel);
    if (river.kept) paintEvents(pen, field, river, seconds, colour);
  };
  const chart = new Chart({
    title, x: seconds, height: 260, range: [0, TOP], yTicks: [0, 0.2, 0.4, 0.6, 0.8, 1], paint,
    series: [{ label: "weights of the hypotheses", values: new Array<null>(river.frames).fill(null), kind: "dots" }],
    rows: () => rowsOf(river, seconds),
    keys: heaviest(river).map((lane) => ({ label: `#${river.lanes[lane].id}`, colour: colour(lane) })),
    seek: (x) => state.seek(x),
  });
  const highlight = (lane: number | undefined) => {
    if (lane === shown) return;
    shown = lane;
    chart.redraw();
  };
  const { over } = chart.plot;
  const find = (event: MouseEvent) => {
    const box = over.getBoundingClientRect();
    const frame = placeOf(seconds, chart.plot.posToVal(event.clientX - box.left, "x"));
    return laneAt(river, frame, chart.plot.posToVal(event.clientY - box.top, "y"));
  };
  over.addEventListener("mousemove", (event) => pointed(find(event)));
  over.addEventListener("mouseleave", () => pointed(undefined));
  return { chart, highlight };
}
