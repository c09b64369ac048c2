// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Marginal angle, table and switches of a mixture's components.
import { DEGREES, log } from "../math/rotation.ts";
import { Chart, type ChartSeries } from "../plots/chart.ts";
import { ChartGroup } from "../plots/group.ts";
import { choice, element, toggle } from "../ui/dom.ts";
import { type AngleFrame, anglesOf, axisOfInterest, histogram } from "./marginal.ts";
import { type Component, type Mixture, positionCovariance, rotationSd } from "./mixture.ts";
import { byWeight, componentColours } from "./order.ts";
import type { Samples } from "./sample.ts";

const BINS = 90;
const MOST_SERIES = 6;
const MOST_TOGGLES = 12;
const AXES = [["0", "x"], ["1", "y"], ["2", "z"], ["all", "all three"]] as const;

function angleChart(mixture: Mixture, samples: Samples, axis: number, frame: AngleFrame, height: number): Chart {
  const angles = anglesOf(mixture, samples, axis, frame);
  const { x, density } = histogram(angles, samples.components, mixture.components.length, BINS);
  const colours = componentColours(mixture);
  const series: ChartSeries[] = [{ label: "all", values: density[0], kind: "shade" }];
  if (mixture.components.length > 1) {
    for (const k of byWeight(mixture).slice(0, MOST_SERIES)) series.push({ label: `component ${k + 1}`, values: density[1 + k], colour: colours[k] });
  }
  return new Chart({ title: `angle about ${"xyz"[axis]}, probability per degree`, x, xLabel: "angle [deg]", series, height });
}

/** The probability of the angle about an axis; first the axis about which there is most to see. */
export function marginal(mixture: Mixture, samples: Samples): HTMLElement {
  const group = new ChartGroup();
  let frame: AngleFrame = "body";
  const first = axisOfInterest(mixture, samples, frame);
  let shown = String(first);
  const fill = () => {
    const axes = shown === "all" ? [0, 1, 2] : [Number(shown)];
    group.replace(axes.map((axis) => angleChart(mixture, samples, axis, frame, axes.length > 1 ? 150 : 230)));
  };
  fill();
  const hint = `Relative to the heaviest component's mean, from ${samples.count} samples; ` +
    `about ${"xyz"[first]} there is most to see${mixture.components.length > MOST_SERIES ? `. Lines: the heaviest ${MOST_SERIES} of ${mixture.components.length} components` : ""}.`;
  return element("div", { class: "marginal" },
    element("div", { class: "controls" },
      choice("Axis", AXES, shown, (value) => ((shown = value), fill())),
      choice("of", [["body", mixture.to], ["reference", mixture.from]], frame, (value) => ((frame = value as AngleFrame), fill()))),
    group.node, element("p", { class: "hint" }, hint));
}

const COLUMNS: readonly (readonly [string, string])[] = [
  ["", ""], ["weight", ""], ["sum of weights", "%"], ["position x, y, z", "mm"], ["sigma x, y, z", "mm"], ["rotation vector", "deg"], ["sigma about x, y, z", "deg"],
];

function rowOf(mixture: Mixture, component: Component, k: number, sum: number, colour: string): HTMLElement {
  const vector = [0, 0, 0];
  log(component.quaternion, vector);
  const p = positionCovariance(mixture, component);
  const at = `${mixture.name}/${k}`;
  const list = (values: number[], digits: number) => values.map((value) => value.toFixed(digits)).join(", ");
  let column = 0;
  // On a narrow page a row is a list, in which every value has its name.
  const cell = (text: string, attributes: Record<string, string> = {}) => {
    const [name, unit] = COLUMNS[++column];
    return element("td", { class: "number", "data-name": unit ? `${name} [${unit}]` : name, ...attributes }, text);
  };
  const dot = element("span", { class: "dot", "aria-hidden": "true" });
  dot.style.setProperty("--swatch", colour);
  return element("tr", {},
    element("th", { scope: "row" }, dot, String(k + 1)),
    cell(String(Number(component.weight.toPrecision(4))), { "data-key": `${at}/weight`, "data-value": JSON.stringify(component.weight) }),
    cell((100 * sum).toFixed(1)),
    cell(list(component.translation.map((value) => 1000 * value), 1), { "data-key": `${at}/translation`, "data-value": JSON.stringify(component.translation) }),
    cell(list([0, 4, 8].map((i) => 1000 * Math.sqrt(p[i])), 2)),
    cell(list(vector.map((angle) => angle * DEGREES), 1)),
    cell(list(rotationSd(mixture, component).map((sd) => sd * DEGREES), 2)));
}

/** The components, the heaviest first, with the sum of the weights so far. */
export function componentTable(mixture: Mixture): HTMLElement {
  const head = element("tr");
  for (const [name, unit] of COLUMNS) {
    head.append(name === "" ? element("td", {}) : element("th", { scope: "col" }, name, ...(unit ? [element("span", { class: "unit" }, ` [${unit}]`)] : [])));
  }
  const colours = componentColours(mixture);
  const body = element("tbody");
  let sum = 0;
  for (const k of byWeight(mixture)) {
    sum += mixture.components[k].weight;
    body.append(rowOf(mixture, mixture.components[k], k, sum, colours[k]));
  }
  const side = mixture.side === "left" ? mixture.from : mixture.to;
  const caption = `T_${mixture.from}_${mixture.to}: ${mixture.distribution} Gaussians, the heaviest first; sigma of the rotation about the axes of ${side}`;
  return element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Components" },
    element("table", { class: "components" }, element("caption", {}, caption), element("thead", {}, head), body));
}

/** Boxes for the heaviest components, one for all others together. */
export function componentToggles(mixture: Mixture, hidden: Set<number>, change: () => void): HTMLElement {
  const parts = element("div", { class: "toggles", role: "group", "aria-label": "Components" });
  const colours = componentColours(mixture);
  const order = byWeight(mixture);
  const add = (text: string, list: readonly number[], colour: string) => {
    const box = toggle(text, true, (on) => {
      for (const k of list) {
        if (on) hidden.delete(k);
        else hidden.add(k);
      }
      change();
    });
    box.style.setProperty("--swatch", colour);
    box.classList.add("swatched");
    parts.append(box);
  };
  // One more box would not be shorter than the last component's.
  const own = order.length <= MOST_TOGGLES + 1 ? order.length : MOST_TOGGLES;
  for (const k of order.slice(0, own)) add(`${k + 1}`, [k], colours[k]);
  const rest = order.slice(own);
  if (rest.length > 0) add(`the other ${rest.length}`, rest, colours[rest[rest.length - 1]]);
  return parts;
}
