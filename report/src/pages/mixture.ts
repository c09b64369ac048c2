// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { componentTable, componentToggles, marginal } from "../mixture/parts.ts";
import { type Mixture, readMixture } from "../mixture/mixture.ts";
import { componentColours } from "../mixture/order.ts";
import { sampleMixture, type Samples } from "../mixture/sample.ts";
import { BadPayload, isObject, type Payload } from "../payload.ts";
import { type FlagLayers, FlagScene } from "../scene/flag_scene.ts";
import { composePicture, savePicture } from "../scene/picture.ts";
import { lengthText } from "../scene/units.ts";
import type { View, Viewport } from "../scene/viewport.ts";
import type { RunState } from "../state/run_state.ts";
import { button, choice, element, toggle } from "../ui/dom.ts";
import { colourOf } from "../ui/palette.ts";
import { files } from "./files.ts";
import { footer, header, noScene, picture, publish } from "./page.ts";
import { fullScreenButton } from "./scene_controls.ts";
import { printMixtures } from "./print_mixture.ts";

const FLAGS = 400;
const DRAWS = 20000;
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

interface Drawn {
  mixture: Mixture;
  /** Few samples, for flags. */
  flags: Samples;
  /** Many samples, for the marginal. */
  many: Samples | undefined;
}

/** The scene and its buttons; undefined if the browser cannot draw it. */
function makeScene(drawn: Drawn[], stage: HTMLElement, shown: () => Mixture): FlagScene | undefined {
  try {
    const most = Math.max(...drawn.map(({ mixture }) => mixture.components.length));
    const scene = new FlagScene("Samples from the mixture as flags", most, FLAGS);
    const views = element("div", { class: "buttons", role: "group", "aria-label": "View of the mixture" },
      ...VIEWS.map(([view, name]) => button(name, () => scene.look(view))));
    const layers = element("div", { class: "toggles", role: "group", "aria-label": "Show of the mixture" },
      ...LAYERS.map(([layer, name]) => toggle(name, scene.layers[layer], (on) => scene.setLayer(layer, on))));
    const save = button("Save picture", () => {
      const mixture = shown();
      const colours = componentColours(mixture);
      const legend = mixture.components.map(({ weight }, k) => ({ text: `${k + 1}: ${(100 * weight).toFixed(1)} %`, colour: colours[k] }));
      savePicture(composePicture(scene.viewport, `${mixture.name}: T_${mixture.from}_${mixture.to}`, legend), `${mixture.name.replace(/\.json$/, "")}_flags.png`);
    });
    stage.append(scene.viewport.node, element("div", { class: "controls" }, views, layers, element("div", { class: "buttons" }, save, ...fullScreenButton(stage))));
    return scene;
  } catch (error) {
    stage.append(noScene(error));
    return undefined;
  }
}

/** What the mixtures of a run are, and the way to the frame that they are of. */
function lastFrameNote(state: RunState): HTMLElement {
  const last = state.trace.frames - 1;
  const text = element("span", {});
  const go = button("Go to the last frame", () => state.go(last));
  const write = () => {
    const here = state.frame === last;
    text.textContent = `All hypotheses at the last frame, ${state.trace.seconds[last].toFixed(2)} s; the trace has but the heaviest of the others. ` +
      (here ? "It is the frame that the page shows." : `The page shows frame ${state.frame} of ${last}.`);
    go.hidden = here;
  };
  state.on("frame", write);
  write();
  return element("p", { class: "hint last-frame" }, text, " ", go);
}

export interface MixtureView {
  node: HTMLElement;
  flagCount: () => number;
  /** For tests. */
  probe: () => unknown;
  viewport: Viewport | undefined;
  /** The mixture that is shown. */
  shown: () => Mixture;
}

const ofObject = (mixture: Mixture, id: string) => mixture.to === id || mixture.name === `mixture_${id}.json`;

/** A mixture of a run has the colour of its object. */
function coloured(mixture: Mixture, state: RunState | undefined): Mixture {
  const index = state?.trace.objects.findIndex(({ id }) => ofObject(mixture, id)) ?? -1;
  return index < 0 ? mixture : { ...mixture, colour: colourOf(index) };
}

/** Scene, marginal and table of one or more mixtures; of a run, those at its last frame. */
export function mixtureView(plain: Mixture[], state?: RunState): MixtureView {
  const mixtures = plain.map((mixture) => coloured(mixture, state));
  const drawn = mixtures.map((mixture): Drawn => ({ mixture, flags: sampleMixture(mixture, FLAGS), many: undefined }));
  const below = element("div", { class: "below" });
  const stage = element("div", { class: "stage" });
  const own = state ? mixtures.findIndex((mixture) => ofObject(mixture, state.nameOf(state.selected))) : 0;
  let at = Math.max(0, own);
  const scene = makeScene(drawn, stage, () => mixtures[at]);
  const hint = element("p", { class: "hint" });
  stage.append(hint);
  let fitted = "";
  const show = (index: number) => {
    at = index;
    const entry = drawn[index];
    const { mixture, flags } = entry;
    const hidden = new Set<number>();
    const update = () => scene?.show(mixture, flags, hidden);
    // Mixtures of one pose, such as the stages of a fusion, share one view.
    const pose = `${mixture.from} ${mixture.to}`;
    if (fitted !== pose) scene?.fit(drawn.filter((one) => `${one.mixture.from} ${one.mixture.to}` === pose));
    fitted = pose;
    update();
    hint.textContent = `${flags.count} poses drawn from the mixture as flags: the foot is the position, the pole the z axis, the pennant points along x.` +
      (scene ? ` Grid: ${lengthText(scene.step)}. Axes of ${mixture.from}.` : "");
    entry.many ??= sampleMixture(mixture, DRAWS, 2);
    below.replaceChildren(
      ...(mixture.components.length > 1 ? [componentToggles(mixture, hidden, update)] : []), marginal(mixture, entry.many), componentTable(mixture));
  };
  show(at);
  const chooser = choice("Mixture", mixtures.map(({ name, to }, i) => [String(i), `${to} (${name})`] as const), String(at), (value) => {
    show(Number(value));
    const entity = state?.trace.objects.findIndex(({ id }) => ofObject(mixtures[at], id)) ?? -1;
    if (entity >= 0) state?.select(entity);
  });
  state?.on("selection", () => {
    const index = mixtures.findIndex((mixture) => ofObject(mixture, state.nameOf(state.selected)));
    if (index < 0 || index === at) return;
    chooser.querySelector("select")!.value = String(index);
    show(index);
  });
  const head = [...(mixtures.length > 1 ? [chooser] : []), ...(state ? [lastFrameNote(state)] : [])];
  return {
    node: element("div", { class: "mixture" }, ...head, element("div", { class: "mixture-parts" }, stage, below)),
    flagCount: () => scene?.flagCount ?? 0,
    probe: () => scene && { labels: scene.viewport.labels.shown, scale: { ...scene.viewport.overlay.scale }, step: scene.step, notes: [...scene.viewport.overlay.notes], top: scene.topPixels() },
    viewport: scene?.viewport,
    shown: () => mixtures[at],
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
    get scene() { return view.probe(); },
  });
  printMixtures(payload, "A pose that may have more than one peak", mixtures, () => view);
  const pictures = Object.entries(payload.pictures).map(([name, svg]) => picture(name, svg));
  return element("div", { class: "page" }, header(payload, "A pose that may have more than one peak"),
    element("main", {}, view.node, ...pictures, ...files(payload)), footer(payload));
}
