// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The scene of a run with its controls.
import { BadPayload, type Payload } from "../payload.ts";
import type { Layers } from "../scene/layers.ts";
import { composePicture, savePicture } from "../scene/picture.ts";
import { pictureName } from "../scene/picture_text.ts";
import { SlamScene } from "../scene/slam_scene.ts";
import { lengthText } from "../scene/units.ts";
import { isView, type View } from "../scene/views.ts";
import type { RunState } from "../state/run_state.ts";
import type { SceneLook } from "../state/scene_look.ts";
import { button, element, toggle } from "../ui/dom.ts";
import { AXIS_COLOURS, colourOf, TRUTH_COLOUR } from "../ui/palette.ts";
import { oneOfChoice } from "../ui/setting_choice.ts";
import { noScene } from "./page.ts";

const LAYERS: readonly (readonly [keyof Layers, string])[] = [
  ["truth", "Ground truth"], ["hypotheses", "Hypotheses"], ["detections", "Detections"], ["labels", "Labels"],
  ["paths", "Paths of objects"], ["images", "Camera images"],
];
const UNCERTAINTY: readonly (readonly [keyof Layers, string, string])[] = [
  ["ellipsoids", "Ellipsoids", "of the position"],
  ["cones", "Rotation cones", "around each axis: where it points, by the standard deviations of the rotation. Of more than six objects only the selected one has them"],
  ["samples", "Samples", "of the selected object: poses drawn from its Gaussian. What the trace has not of how position and rotation go together is taken as independent"],
  ["lengths", "Axes in mm", "of the selected object: principal axes of the position, with their true lengths"],
];
const VIEWS: readonly (readonly [View, string])[] = [
  ["fit", "All"], ["near", "Objects"], ["top", "Top"], ["front", "Front"], ["side", "Side"], ["eye", "Camera"],
];

function viewButtons(scene: SlamScene, state: RunState): HTMLElement {
  const views = element("div", { class: "buttons", role: "group", "aria-label": "View" });
  const presses = new Map<string, HTMLButtonElement>();
  const mark = () => presses.forEach((press, view) => press.setAttribute("aria-pressed", String(view === state.view)));
  for (const [view, name] of VIEWS) {
    const press = button(name, () => {
      // The view that is chosen already is restored, after it was turned.
      if (state.view === view) scene.look(view);
      else state.setView(view);
    });
    presses.set(view, press);
    views.append(press);
  }
  state.on("view", () => {
    if (isView(state.view)) scene.look(state.view);
    mark();
  });
  mark();
  return views;
}

function layerToggles(scene: SlamScene, state: RunState): HTMLElement {
  const layers = element("div", { class: "toggles", role: "group", "aria-label": "Show" });
  for (const [layer, name] of LAYERS) {
    if (layer === "truth" && !state.trace.hasTruth) continue;
    if (layer === "paths" && !scene.objectPaths.any) continue;
    if (layer === "images" && !scene.images.any) continue;
    layers.append(toggle(name, scene.layers[layer], (on) => scene.setLayer(layer, on)));
  }
  const follow = toggle("Follow", state.follow, (on) => state.setFollow(on));
  follow.title = "The view moves with the selected object";
  state.on("follow", () => (follow.querySelector("input")!.checked = state.follow));
  layers.append(follow);
  return layers;
}

function uncertaintyControls(scene: SlamScene, look: SceneLook): HTMLElement {
  const list = element("div", { class: "toggles", role: "group", "aria-label": "Uncertainty" });
  for (const [layer, name, text] of UNCERTAINTY) {
    const box = toggle(name, scene.layers[layer], (on) => scene.setLayer(layer, on));
    box.title = text;
    list.append(box);
  }
  list.append(oneOfChoice("Size", look.sigma), oneOfChoice("drawn", look.factor), oneOfChoice("Covariance", look.frame));
  look.onChange(() => scene.setLook(look.value));
  return list;
}

/** What the scene shows, and how it is read; closed on a screen that is too low for it and the scene. */
function drawnPanel(scene: SlamScene, state: RunState, look: SceneLook): HTMLElement {
  return element("details", { class: "drawn", open: innerWidth > 700 && innerHeight >= 1000 }, element("summary", {}, "What is drawn"),
    layerToggles(scene, state), uncertaintyControls(scene, look), hintOf(scene));
}

/** The whole screen for the scene and its timeline. */
export function fullScreenButton(stage: HTMLElement): HTMLButtonElement[] {
  if (!document.fullscreenEnabled) return [];
  const press = button("Full screen", () => void (document.fullscreenElement === stage ? document.exitFullscreen() : stage.requestFullscreen()));
  document.addEventListener("fullscreenchange", () => (press.textContent = document.fullscreenElement === stage ? "Leave full screen" : "Full screen"));
  return [press];
}

function saveButton(scene: SlamScene, state: RunState): HTMLButtonElement {
  return button("Save picture", () => {
    const { trace } = state;
    const shown = trace.objects.map(({ id }, i) => ({ text: id, colour: colourOf(i), i })).filter(({ i }) => !state.hidden.has(i));
    const axes = ["x", "y", "z"].map((text, k) => ({ text, colour: AXIS_COLOURS[k] }));
    const truth = trace.hasTruth && scene.layers.truth ? [{ text: "ground truth", colour: TRUTH_COLOUR }] : [];
    const title = `${trace.head.name}, ${trace.head.method}, ${state.seconds.toFixed(2)} s, frame ${state.frame}`;
    savePicture(composePicture(scene.viewport, title, [...shown, ...truth, ...axes]), pictureName(trace.head.name, state.seconds));
  }, { title: "The scene as PNG, with labels, scale and legend" });
}

function hintOf(scene: SlamScene): HTMLElement {
  const camera = scene.hasLens ? "" : " The pyramid only stands for the camera: its intrinsics are not known.";
  return element("details", { class: "hint scene-hint" }, element("summary", {}, "How to read and move this"),
    element("p", {}, `Axes: x red, y green, z blue; the world's are at its origin and at the lower right, where a press looks along one. Grid: ${lengthText(scene.gridStep)}.`),
    element("p", {}, "Ghosts: hypotheses, the fainter the less probable. Grey: ground truth. Cones open to at most 75 deg. " +
      `Samples use the standard deviations and the position's covariance of the trace; other correlations of rotation and position are taken as zero.${camera}`),
    element("p", {}, "Drag to turn, right button or two fingers to shift; Ctrl and wheel zoom, or the wheel alone once the scene was pressed. " +
      "A click selects, a double click centres, the resting pointer tells sigma."));
}

/** The scene, or what to do where it cannot be drawn. */
export function makeScene(state: RunState, payload: Payload, look: SceneLook): { node: HTMLElement; scene: SlamScene | undefined } {
  const stage = element("div", { class: "stage" });
  let scene: SlamScene;
  try {
    scene = new SlamScene(state, payload.meshes, payload.images);
  } catch (error) {
    if (error instanceof BadPayload) throw error;
    stage.append(noScene(error));
    return { node: stage, scene: undefined };
  }
  const tools = element("div", { class: "buttons" }, saveButton(scene, state), ...fullScreenButton(stage));
  const row = element("div", { class: "controls scene-controls" }, viewButtons(scene, state), tools);
  stage.append(scene.viewport.node, row, drawnPanel(scene, state, look));
  return { node: stage, scene };
}
