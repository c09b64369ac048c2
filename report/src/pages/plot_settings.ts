// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What the tabs with plots have in common: settings that they share, and lists to choose from.
import type { RotationAs } from "../plots/series.ts";
import { CAMERA, type Entity, type RunState } from "../state/run_state.ts";
import { Setting } from "../state/setting.ts";
import type { Of } from "../trace/squares.ts";
import { choice, element } from "../ui/dom.ts";
import { settingChoice } from "../ui/setting_choice.ts";

export interface Plots {
  state: RunState;
  rotationAs: Setting<RotationAs>;
  of: Setting<Of>;
}

export function plotsOf(state: RunState): Plots {
  return { state, rotationAs: new Setting<RotationAs>("vector"), of: new Setting<Of>("relative") };
}

/** A tab that is filled anew when what it shows has changed; one that is not seen waits until it is. */
export class Refill {
  private stale = false;

  constructor(private readonly node: HTMLElement, private readonly fill: () => void) {}

  request(): void {
    if (this.node.closest("[hidden]")) this.stale = true;
    else this.now();
  }

  now(): void {
    this.stale = false;
    this.fill();
  }

  opened(): void {
    if (this.stale) this.now();
  }
}

export interface PlotTab {
  node: HTMLElement;
  opened: () => void;
}

export const rotationChoice = ({ rotationAs }: Plots): HTMLLabelElement =>
  settingChoice("Rotation as", [["vector", "rotation vector"], ["rpy", "roll, pitch, yaw"]], rotationAs);

/** In which frame the pose of an object is; the camera's is in the world. */
export function frameChoice({ of, state }: Plots): HTMLLabelElement {
  const made = settingChoice("in the frame of", [["relative", "the camera"], ["world", "the world"]], of);
  const update = () => (made.hidden = state.selected === CAMERA);
  state.on("selection", update);
  update();
  return made;
}

/** A list of the objects, with `camera` of it too, which shows and changes the selected one. */
export function entityChoice(state: RunState, text: string, camera: boolean): HTMLLabelElement {
  const names = state.trace.objects.map(({ id }, i) => [String(i), id] as const);
  const first = camera ? [[String(CAMERA), state.nameOf(CAMERA)] as const] : [];
  const chosen = () => String(camera ? state.selected : Math.max(0, state.selected));
  const made = choice(text, [...first, ...names], chosen(), (value) => state.select(Number(value)));
  state.on("selection", () => (made.querySelector("select")!.value = chosen()));
  return made;
}

/** The selected object; for the camera the one before it. */
export function selectedObject(state: RunState): () => Entity {
  let last = Math.max(0, state.selected);
  return () => (state.selected === CAMERA ? last : (last = state.selected));
}

export const notice = (text: string): HTMLElement => element("p", { class: "notice" }, text);

/** Where a pose is stated, in words. */
export const frameWords = (entity: Entity, of: Of): string => (entity === CAMERA || of === "world" ? "world" : "camera");
