// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { DEGREES, log } from "../math/rotation.ts";
import { type AngleFrame, anglesOf, histogram } from "../mixture/marginal.ts";
import { type Mixture, positionCovariance, readMixture, rotationSd } from "../mixture/mixture.ts";
import { sampleMixture, type Samples } from "../mixture/sample.ts";
import { BadPayload, isObject, type Payload } from "../payload.ts";
import { Chart, type ChartSeries } from "../plots/chart.ts";
import { ChartGroup } from "../plots/group.ts";
import { type FlagLayers, FlagScene } from "../scene/flag_scene.ts";
import type { View } from "../scene/viewport.ts";
import { button, choice, element, toggle } from "../ui/dom.ts";
import { colourOf } from "../ui/palette.ts";
import { table } from "../ui/table.ts";
import { files } from "./files.ts";
import { footer, header, noScene, picture, publish } from "./page.ts";

const FLAGS = 400;
const DRAWS = 20000;
const BINS = 90;
const MOST_SERIES = 8;
const MOST_TOGGLES = 16;
const LAYERS: readonly (readonly [keyof FlagLayers, string])[] = [
  ["flags", "Flags"], ["means", "Means"], ["ellipsoids", "3-sigma ellipsoids"], ["labels", "Labels"],
];
const VIEWS: readonly (readonly [View, string])[] = [["fit", "All"], ["top", "Top"], ["front", "Front"], ["side", "Side"]];

/** The mixtures among the documents. */
export function mixtureDocuments(payload: Payload): Mixture[] {
  return Object.entries(payload.documents)
    .filter(([, document]) => isObject(document) && document["type"] === "posemix.mixture")
    .map(([name, document]) => readMixture(name, document));
}

/** The numbers of the components with the largest weights, in their order. */
function heaviest({ components }: Mixture, most: number): number[] {
  const byWeight = components.map((_, k) => k).sort((a, b) => components[b].weight - components[a].weight);
  return byWeight.slice(0, most).sort((a, b) => a - b);
}

function marginal(mixture: Mixture, samples: Samples, group: ChartGroup): HTMLElement {
  let axis = 2;
  let frame: AngleFrame = "body";
  const fill = () => {
    const angles = anglesOf(mixture, samples, axis, frame);
    const { x, density } = histogram(angles, samples.components, mixture.components.length, BINS);
    const series: ChartSeries[] = [{ label: "all", values: density[0], kind: "shade" }];
    for (const k of mixture.components.length > 1 ? heaviest(mixture, MOST_SERIES) : []) {
      series.push({ label: `component ${k + 1}`, values: density[1 + k], colour: colourOf(k) });
    }
    group.replace([new Chart({ title: `angle about ${"xyz"[axis]}, probability per degree`, x, xLabel: "angle [deg]", series, height: 260 })]);
  };
  fill();
  return element("div", {},
    element("div", { class: "controls" },
      choice("Axis", [["0", "x"], ["1", "y"], ["2", "z"]], "2", (value) => ((axis = Number(value)), fill())),
      choice("of", [["body", mixture.to], ["reference", mixture.from]], frame, (value) => ((frame = value as AngleFrame), fill())),
      element("p", { class: "hint" }, `Relative to the heaviest component's mean, from ${samples.count} samples.`)),
    group.node);
}

function componentTable(mixture: Mixture): HTMLElement {
  const columns = ["", "weight", "x_m", "y_m", "z_m", "rotation_vector_deg", "rotation_sd_deg", "position_sd_mm"];
  const rows = mixture.components.map((component, k) => {
    const r = [0, 0, 0];
    log(component.quaternion, r);
    const p = positionCovariance(mixture, component);
    const list = (values: number[], digits: number) => values.map((value) => value.toFixed(digits)).join(", ");
    const at = `${mixture.name}/${k}`;
    return {
      name: String(k + 1),
      cells: [
        { value: component.weight, key: `${at}/weight` },
        ...component.translation.map((value, i) => ({ value, key: `${at}/translation/${i}` })),
        { value: list(r.map((angle) => angle * DEGREES), 2) },
        { value: list(rotationSd(mixture, component).map((sd) => sd * DEGREES), 2) },
        { value: list([0, 4, 8].map((i) => 1000 * Math.sqrt(p[i])), 2) },
      ],
    };
  });
  const side = mixture.side === "left" ? `axes of ${mixture.from}` : `axes of ${mixture.to}`;
  return table(`T_${mixture.from}_${mixture.to}: ${mixture.distribution} Gaussians; rotation sd about the ${side}`, columns, rows);
}

interface Drawn {
  mixture: Mixture;
  /** Few samples, for flags. */
  flags: Samples;
  /** Many samples, for the marginal. */
  many: Samples | undefined;
}

/** The scene and its buttons; undefined if the browser cannot draw it. */
function makeScene(drawn: Drawn[], stage: HTMLElement): FlagScene | undefined {
  try {
    const most = Math.max(...drawn.map(({ mixture }) => mixture.components.length));
    const scene = new FlagScene("Samples from the mixture as flags", most, FLAGS);
    const views = element("div", { class: "buttons", role: "group", "aria-label": "View" },
      ...VIEWS.map(([view, name]) => button(name, () => scene.viewport.look(view))));
    const layers = element("div", { class: "toggles", role: "group", "aria-label": "Show" },
      ...LAYERS.map(([layer, name]) => toggle(name, scene.layers[layer], (on) => scene.setLayer(layer, on))));
    stage.append(scene.viewport.node, element("div", { class: "controls" }, views, layers),
      element("p", { class: "hint" }, "A flag's foot is the position, its pole the z axis, its pennant points along x."));
    return scene;
  } catch (error) {
    stage.append(noScene(error));
    return undefined;
  }
}

function componentToggles(mixture: Mixture, hidden: Set<number>, change: () => void): HTMLElement {
  const parts = element("div", { class: "toggles", role: "group", "aria-label": "Components" });
  for (const k of heaviest(mixture, MOST_TOGGLES)) {
    const box = toggle(`${k + 1}`, true, (on) => {
      if (on) hidden.delete(k);
      else hidden.add(k);
      change();
    });
    box.style.setProperty("--swatch", colourOf(k));
    box.classList.add("swatched");
    parts.append(box);
  }
  return parts;
}

export interface MixtureView {
  node: HTMLElement;
  flagCount: () => number;
}

/** Scene, marginal and table of one or more mixtures. */
export function mixtureView(mixtures: Mixture[]): MixtureView {
  const drawn = mixtures.map((mixture): Drawn => ({ mixture, flags: sampleMixture(mixture, FLAGS), many: undefined }));
  const below = element("div", { class: "below" });
  const stage = element("div", { class: "stage" });
  const scene = makeScene(drawn, stage);
  let fitted = "";
  const show = (index: number) => {
    const entry = drawn[index];
    const { mixture, flags } = entry;
    const hidden = new Set<number>();
    const update = () => scene?.show(mixture, flags, hidden);
    // Mixtures of one pose, such as the stages of a fusion, share one view.
    const pose = `${mixture.from} ${mixture.to}`;
    if (fitted !== pose) scene?.fit(mixture.from, drawn.filter((one) => `${one.mixture.from} ${one.mixture.to}` === pose).map((one) => one.flags));
    fitted = pose;
    update();
    entry.many ??= sampleMixture(mixture, DRAWS, 2);
    below.replaceChildren(
      ...(mixture.components.length > 1 ? [componentToggles(mixture, hidden, update)] : []),
      marginal(mixture, entry.many, new ChartGroup()), componentTable(mixture));
  };
  show(0);
  const chooser = mixtures.length > 1
    ? [choice("Mixture", mixtures.map(({ name, to }, i) => [String(i), `${to} (${name})`] as const), "0", (value) => show(Number(value)))]
    : [];
  return {
    node: element("div", { class: "mixture" }, ...chooser, element("div", { class: "columns" }, stage, below)),
    flagCount: () => scene?.flagCount ?? 0,
  };
}

export function mixturePage(payload: Payload): HTMLElement {
  const mixtures = mixtureDocuments(payload);
  if (mixtures.length === 0) throw new BadPayload('A report of kind "mixture" needs a document of type "posemix.mixture".');
  const view = mixtureView(mixtures);
  publish({
    kind: "mixture",
    names: mixtures.map(({ name }) => name),
    get flags() { return view.flagCount(); },
  });
  const pictures = Object.entries(payload.pictures).map(([name, svg]) => picture(name, svg));
  return element("div", { class: "page" }, header(payload, "A pose that may have more than one peak"),
    element("main", {}, view.node, ...pictures, ...files(payload)), footer(payload));
}
