// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import type { Payload } from "../payload.ts";
import type { ChartGroup } from "../plots/group.ts";
import { bindAddress } from "../state/address.ts";
import { EventChoice } from "../state/event_choice.ts";
import { PoseDisplay } from "../state/pose_display.ts";
import { RunFacts } from "../state/run_facts.ts";
import { RunState } from "../state/run_state.ts";
import { SceneLook } from "../state/scene_look.ts";
import { readTrace } from "../trace/trace.ts";
import { element } from "../ui/dom.ts";
import { Keys } from "../ui/keys.ts";
import { linkRows } from "../ui/linked_rows.ts";
import { Player } from "../ui/player.ts";
import { Strips } from "../ui/strips.ts";
import { type Tab, type Tabs, tabs } from "../ui/tabs.ts";
import { eventsList } from "./events_list.ts";
import { files } from "./files.ts";
import { metrics } from "./metrics.ts";
import { mixtureDocuments, mixtureView } from "./mixture.ts";
import { overview } from "./overview.ts";
import { footer, header, picture, publish } from "./page.ts";
import { printRun } from "./print_run.ts";
import { makeScene } from "./scene_controls.ts";
import { plotTabs } from "./slam_plots.ts";
import { StateTable } from "./state_table.ts";

/** A tab whose content is told when it is opened. */
function opened(name: string, build: () => { node: HTMLElement; open: () => void }): Tab {
  let made: ReturnType<typeof build> | undefined;
  return { name, build: () => (made = build()).node, open: () => made?.open() };
}

interface Shared {
  facts: RunFacts;
  events: EventChoice;
  display: PoseDisplay;
}

function makeTabs(state: RunState, payload: Payload, groups: ChartGroup[], { facts, events, display }: Shared): Tabs {
  const numbers = payload.documents["metrics.json"];
  const list: Tab[] = [
    opened("Overview", () => overview(state, facts, display, numbers)),
    opened("Events", () => eventsList(state, facts, events)),
    ...plotTabs(state, facts, groups),
    { name: "Numbers", build: () => linkRows(metrics(numbers, state.trace.cameraName), state) },
  ];
  const mixtures = mixtureDocuments(payload);
  if (mixtures.length > 0) list.push({ name: "Mixtures", build: () => mixtureView(mixtures, state).node });
  const rest = files(payload);
  const pictures = Object.entries(payload.pictures).map(([name, svg]) => picture(name, svg));
  if (rest.length + pictures.length > 0) list.push({ name: "Files", build: () => element("div", {}, ...pictures, ...rest) });
  return tabs("Plots and numbers", list, (name) => state.setTab(name));
}

/** Keys for the selected object, and from event to event. */
function addRunKeys(state: RunState, events: EventChoice, keys: Keys): void {
  const step = (by: number) => () => {
    const count = state.trace.objects.length + 1;
    state.select(((state.selected + 1 + by + count) % count) - 1);
  };
  keys.add(["]"], "select the next object", step(1));
  keys.add(["["], "select the object before", step(-1));
  keys.add(["o"], "show the selected object alone, or all", () => state.solo(state.selected));
  keys.add(["h"], "hide or show the selected object", () => state.setHidden(state.selected, !state.hidden.has(state.selected)));
  keys.add(["n"], "the next event; with shift of the selected object", ({ shiftKey }) => events.step(1, shiftKey));
  keys.add(["p"], "the event before; with shift of the selected object", ({ shiftKey }) => events.step(-1, shiftKey));
  keys.add(["f"], "follow the selected object", () => state.setFollow(!state.follow));
}

export async function slamPage(payload: Payload): Promise<HTMLElement> {
  const started = performance.now();
  const trace = await readTrace(payload.trace!);
  const decoded = performance.now();
  const facts = new RunFacts(trace, payload.documents["metrics.json"]);
  const state = new RunState(trace, facts.byDoubt[0]);
  const shared = { facts, events: new EventChoice(state, facts), display: new PoseDisplay() };
  const keys = new Keys();
  const look = new SceneLook();
  const { node: stage, scene } = makeScene(state, payload, look);
  const table = new StateTable(state, shared.display);
  const groups: ChartGroup[] = [];
  const player = new Player(state, keys);
  new Strips(state, shared.events, player.strips);
  const pages = makeTabs(state, payload, groups, shared);
  state.on("tab", () => pages.show(state.tab));
  addRunKeys(state, shared.events, keys);
  let updateTime = 0;
  const show = () => {
    const start = performance.now();
    scene?.update(state.frame);
    for (const group of groups) group.update(state.seconds);
    updateTime = performance.now() - start;
    table.update();
    scene?.viewport.invalidate();
  };
  state.on("frame", show);
  (scene?.viewport.node ?? stage.firstElementChild!).after(player.node);
  stage.append(table.node);
  const node = element("div", { class: "page slam" }, header(payload, `${trace.head.method} · ${trace.frames} frames`, keys),
    element("main", { class: "columns" }, stage, pages.node), footer(payload));
  show();
  const { reference, rotation } = shared.display;
  bindAddress(state, { sigma: look.sigma, exaggeration: look.factor, covariance: look.frame, poses: reference, rotation });
  const seen = () => {
    // Labels take the colours of paper.
    scene?.update(state.frame);
    return scene?.viewport;
  };
  printRun(payload, trace, seen, () => `${state.seconds.toFixed(2)} s`);
  publish({
    kind: "slam",
    frames: trace.frames,
    get frame() { return state.frame; },
    get events() { return facts.events; },
    get selected() { return state.nameOf(state.selected); },
    get updateTime() { return updateTime; },
    get drawTime() { return scene?.viewport.drawTime; },
    get firstDraw() { return scene?.viewport.firstDraw; },
    get ghosts() { return scene?.ghostCount; },
    get faint() { return scene?.faint.axes.mesh.count; },
    get ellipsoids() { return scene?.ellipsoidCount; },
    get bodies() { return scene?.bodyIds; },
    scene: scene?.probe,
    decodeTime: decoded - started,
    pose: (id: string) => {
      const entity = state.entityOf(id);
      return entity === undefined ? undefined : scene?.shown(entity);
    },
  });
  return node;
}
