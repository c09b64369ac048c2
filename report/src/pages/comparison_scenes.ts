// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The scenes of a comparison: all runs in one, or one per run beside each other, which turn and play together.
import type { Comparison, Run } from "../compare/runs.ts";
import { ComparisonScene } from "../scene/comparison_scene.ts";
import { SlamScene } from "../scene/slam_scene.ts";
import type { View, Viewport } from "../scene/viewport.ts";
import { RunState } from "../state/run_state.ts";
import { button, element, toggle } from "../ui/dom.ts";
import { noScene } from "./page.ts";

const VIEWS: readonly (readonly [View, string])[] = [["fit", "All"], ["top", "Top"], ["front", "Front"], ["side", "Side"]];
/** Browsers allow few scenes at once. */
const MOST_SCENES = 6;

interface Beside {
  run: Run;
  state: RunState;
  scene: SlamScene;
}

/** Turns all scenes as one of them is turned. */
function link(viewports: Viewport[]): void {
  let busy = false;
  for (const from of viewports) {
    from.controls.addEventListener("change", () => {
      if (busy) return;
      busy = true;
      for (const to of viewports) {
        if (to === from) continue;
        to.camera.position.copy(from.camera.position);
        to.camera.up.copy(from.camera.up);
        to.controls.target.copy(from.controls.target);
        to.controls.update();
        to.invalidate();
      }
      busy = false;
    });
  }
}

export class ComparisonScenes {
  readonly node = element("div", { class: "scenes" });
  readonly overlay: ComparisonScene;
  private readonly place = element("div", { class: "places" });
  private readonly legend = element("div", { class: "toggles", role: "group", "aria-label": "Runs" });
  private readonly choose: HTMLButtonElement[];
  private beside: Beside[] = [];
  private isBeside = false;

  /** @throws Error if the browser has no WebGL */
  constructor(private readonly comparison: Comparison, private readonly state: RunState) {
    this.overlay = new ComparisonScene(comparison);
    this.choose = [["Overlaid", false], ["Side by side", true]].map(([name, beside]) => button(String(name), () => this.arrange(beside === true)));
    const views = VIEWS.map(([view, name]) => button(name, () => this.look(view)));
    for (const run of comparison.runs) {
      const box = toggle(run.name, true, (on) => this.overlay.setShown(run, on));
      box.style.setProperty("--swatch", run.colour);
      box.classList.add("swatched");
      this.legend.append(box);
    }
    this.node.append(this.place,
      element("div", { class: "controls" },
        element("div", { class: "buttons", role: "group", "aria-label": "Arrangement" }, ...this.choose),
        element("div", { class: "buttons", role: "group", "aria-label": "View" }, ...views), this.legend));
    this.arrange(false);
    state.on("frame", () => this.update());
    state.on("visibility", () => this.update());
    this.update();
  }

  get count(): number {
    return this.isBeside ? this.beside.length : 1;
  }

  /** The scene that print shows. */
  get viewport(): Viewport {
    return this.overlay.viewport;
  }

  /** The frames that the scenes beside each other show, by run. */
  get frames(): Record<string, number> {
    return Object.fromEntries(this.beside.map(({ run, state }) => [run.name, state.frame]));
  }

  /** Where the scenes are seen from, for tests. */
  get eyes(): number[][] {
    return (this.isBeside ? this.beside.map(({ scene }) => scene.viewport) : [this.overlay.viewport]).map(({ camera }) => camera.position.toArray());
  }

  private arrange(beside: boolean): void {
    this.isBeside = beside;
    this.choose.forEach((one, i) => one.setAttribute("aria-pressed", String((i === 1) === beside)));
    this.legend.hidden = beside;
    this.place.classList.toggle("beside", beside);
    if (!beside) {
      this.place.replaceChildren(this.overlay.viewport.node);
      this.update();
      return;
    }
    if (this.beside.length === 0) this.makeBeside();
    const left = this.comparison.runs.length - this.beside.length;
    this.place.replaceChildren(...this.beside.map(({ run, scene }) => {
      const name = element("figcaption", {}, run.name);
      name.style.setProperty("--swatch", run.colour);
      name.classList.add("swatched");
      return element("figure", { class: "beside-one" }, name, scene.viewport.node);
    }), ...(left > 0 ? [element("p", { class: "hint" }, `${left} more runs are in the overlaid scene: a browser draws few scenes at once.`)] : []));
    this.update();
    this.look("fit");
  }

  private makeBeside(): void {
    this.beside = this.comparison.runs.slice(0, MOST_SCENES).map((run) => {
      const state = new RunState(run.trace);
      const scene = new SlamScene(state, {});
      // All scenes show the same part of space.
      scene.viewport.setBounds(this.overlay.bounds);
      return { run, state, scene };
    });
    link(this.beside.map(({ scene }) => scene.viewport));
  }

  private look(view: View): void {
    if (this.isBeside) for (const { scene } of this.beside) scene.look(view);
    else this.overlay.viewport.look(view);
  }

  private update(): void {
    if (!this.isBeside) {
      this.overlay.update(this.state.frame);
      return;
    }
    const { timeline } = this.comparison;
    for (const { run, state, scene } of this.beside) {
      const shown = run.shown[this.state.frame];
      // A run that has ended stays at its last frame.
      state.go(shown >= 0 ? shown : this.state.seconds > run.span[0] ? run.trace.frames - 1 : 0);
      timeline.objects.forEach(({ id }, i) => {
        const own = run.trace.objects.findIndex((object) => object.id === id);
        if (own >= 0) state.setHidden(own, this.state.hidden.has(i));
      });
      scene.update(state.frame);
      scene.viewport.invalidate();
    }
  }
}

export function makeScenes(comparison: Comparison, state: RunState): { node: HTMLElement; scenes: ComparisonScenes | undefined } {
  try {
    const scenes = new ComparisonScenes(comparison, state);
    return { node: scenes.node, scenes };
  } catch (error) {
    return { node: noScene(error), scenes: undefined };
  }
}
