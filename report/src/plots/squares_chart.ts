// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// NEES and NIS over time with their chi-square band.
import type { RunState } from "../state/run_state.ts";
import { BAND, POSE_DOF, withinBand } from "../trace/squares.ts";
import { OUTSIDE_COLOUR } from "./colours.ts";
import { Chart, type ChartSeries, type Values } from "./chart.ts";
import { percent } from "./coverage.ts";

const LEAST = 0.2;
const MOST = 1000;

function squaresChart(state: RunState, label: string, values: Values, colour: string, dots: boolean): Chart {
  const { seconds, frames } = state.trace;
  const constant = (value: number): Values => new Array<number>(frames).fill(value);
  const { frames: count, within, above } = withinBand(values);
  const logs: Values = values.map((value) => (value === null ? null : Math.max(value, 1e-3)));
  const high = values.reduce<number>((top, value) => Math.max(top, value ?? 0), BAND[1]);
  const series: ChartSeries[] = [
    { label: "95 % band of chi-square", values: constant(BAND[1]), lower: constant(BAND[0]), kind: "band", quiet: true },
    { label: "expected", values: constant(POSE_DOF), kind: "dashed", quiet: true },
    { label, values: logs, colour, ...(dots ? { kind: "dots" as const } : {}) },
    { label: "above the band", values: logs.map((value) => (value !== null && value > BAND[1] ? value : null)), kind: "dots", colour: OUTSIDE_COLOUR, size: 3.4, quiet: true },
  ];
  return new Chart({
    title: `${label}, ${POSE_DOF} degrees of freedom`, x: seconds, series, height: 200, yLog: true,
    range: [LEAST, Math.min(MOST, Math.max(100, 1.5 * high))], seek: (at) => state.seek(at),
    note: count === 0 ? "There are none." : `${percent(within / count)} of ${count} frames within ${BAND[0].toFixed(2)} to ${BAND[1].toFixed(2)} (95 % expected), ${percent(above / count)} above (2.5 % expected)`,
  });
}

export const neesChart = (state: RunState, values: Values, colour: string): Chart => squaresChart(state, "NEES", values, colour, false);
export const nisChart = (state: RunState, values: Values, colour: string): Chart => squaresChart(state, "NIS of the innovation", values, colour, true);
