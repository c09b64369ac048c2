// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import type { Payload } from "../payload.ts";
import { ChartGroup } from "../plots/group.ts";
import type { Layers } from "../scene/layers.ts";
import { SlamScene } from "../scene/slam_scene.ts";
import type { View } from "../scene/viewport.ts";
import { readTrace, type Trace } from "../trace/trace.ts";
import { button, element, toggle } from "../ui/dom.ts";
import { Player } from "../ui/player.ts";
import { type Tab, tabs } from "../ui/tabs.ts";
import { files } from "./files.ts";
import { metrics } from "./metrics.ts";
import { mixtureDocuments, mixtureView } from "./mixture.ts";
import { footer, header, noScene, picture, publish } from "./page.ts";
import { detectionPlots, errorPlots, statusPlots, hypothesisPlots, type Seek } from "./slam_plots.ts";
import { StateTable } from "./state_table.ts";
import { trackPlots } from "./track_plots.ts";

const LAYERS: readonly (readonly [keyof Layers, string])[] = [
  ["truth", "Ground truth"], ["ellipsoids", "3-sigma ellipsoids"], ["hypotheses", "Hypotheses"],
  ["detections", "Detections"], ["labels", "Labels"], ["paths", "Paths of objects"],
];
const VIEWS: readonly (readonly [View, string])[] = [
  ["fit", "All"], ["near", "Objects"], ["top", "Top"], ["front", "Front"], ["side", "Side"], ["eye", "Camera"],
];

function sceneControls(scene: SlamScene, trace: Trace): HTMLElement {
  const views = element("div", { class: "buttons", role: "group", "aria-label": "View" });
  for (const [view, name] of VIEWS) views.append(button(name, () => scene.look(view)));
  const layers = element("div", { class: "toggles", role: "group", "aria-label": "Show" });
  for (const [layer, name] of LAYERS) {
    if (layer === "truth" && !trace.hasTruth) continue;
    if (layer === "paths" && !scene.objectPaths.any) continue;
    layers.append(toggle(name, scene.layers[layer], (on) => scene.setLayer(layer, on)));
  }
  return element("div", { class: "controls" }, views, layers);
}

function gridText(step: number): string {
  return step >= 1 ? `${step} m` : step >= 0.01 ? `${Number((100 * step).toPrecision(2))} cm` : `${Number((1000 * step).toPrecision(2))} mm`;
}

function makeScene(trace: Trace, payload: Payload): { node: HTMLElement; scene: SlamScene | undefined } {
  try {
    const scene = new SlamScene(trace, payload.meshes);
    const hint = element("p", { class: "hint" },
      `Axes: x orange, y green, z blue. Ghosts: hypotheses, the fainter the less probable. Grid: ${gridText(scene.gridStep)}.`);
    return { node: element("div", { class: "stage" }, scene.viewport.node, sceneControls(scene, trace), hint), scene };
  } catch (error) {
    return { node: element("div", { class: "stage" }, noScene(error)), scene: undefined };
  }
}

function makeTabs(trace: Trace, payload: Payload, seek: Seek, groups: ChartGroup[]): HTMLElement {
  const plots = (name: string, build: (trace: Trace, group: ChartGroup, seek: Seek) => HTMLElement): Tab => {
    const group = new ChartGroup();
    groups.push(group);
    return { name, build: () => build(trace, group, seek), open: () => group.mark() };
  };
  const list: Tab[] = [
    plots("Detections", detectionPlots),
    plots("Errors", errorPlots),
    plots("Hypotheses", hypothesisPlots),
    plots("Status", statusPlots),
    ...(trace.hasTracks ? [plots("Tracks", trackPlots)] : []),
    { name: "Numbers", build: () => metrics(payload.documents["metrics.json"]) },
  ];
  const mixtures = mixtureDocuments(payload);
  if (mixtures.length > 0) list.push({ name: "Mixtures", build: () => mixtureView(mixtures).node });
  const rest = files(payload);
  const pictures = Object.entries(payload.pictures).map(([name, svg]) => picture(name, svg));
  if (rest.length + pictures.length > 0) list.push({ name: "Files", build: () => element("div", {}, ...pictures, ...rest) });
  return tabs("Plots and numbers", list);
}

export async function slamPage(payload: Payload): Promise<HTMLElement> {
  const started = performance.now();
  const trace = await readTrace(payload.trace!);
  const decoded = performance.now();
  const { node: stage, scene } = makeScene(trace, payload);
  const state = new StateTable(trace);
  const groups: ChartGroup[] = [];
  let updateTime = 0;
  const show = (frame: number) => {
    const start = performance.now();
    scene?.update(frame);
    for (const group of groups) group.update(trace.seconds[frame]);
    updateTime = performance.now() - start;
    state.update(frame);
    scene?.viewport.invalidate();
  };
  const player = new Player(trace, show);
  stage.append(player.node, state.node);
  const node = element("div", { class: "page slam" }, header(payload, `${trace.head.method} · ${trace.frames} frames`),
    element("main", { class: "columns" }, stage, makeTabs(trace, payload, (seconds) => player.seek(seconds), groups)), footer(payload));
  show(0);
  publish({
    kind: "slam",
    frames: trace.frames,
    get frame() { return player.frame; },
    get updateTime() { return updateTime; },
    get drawTime() { return scene?.viewport.drawTime; },
    get firstDraw() { return scene?.viewport.firstDraw; },
    get ghosts() { return scene?.ghostCount; },
    get faint() { return scene?.faint.axes.mesh.count; },
    get ellipsoids() { return scene?.ellipsoidCount; },
    get bodies() { return scene?.bodyIds; },
    decodeTime: decoded - started,
    pose: (id: string) => scene?.shown(id === "camera" ? "camera" : trace.objects.findIndex((object) => object.id === id)),
  });
  return node;
}
