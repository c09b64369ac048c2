// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Words that lead to a moment of the run.
import type { Entity, RunState } from "../state/run_state.ts";
import { button } from "./dom.ts";
import { time } from "./numbers.ts";

/** Shows a frame and selects an object. */
export function momentLink(state: RunState, frame: number, entity: Entity, text = time(state.trace.seconds[frame])): HTMLButtonElement {
  const press = () => {
    state.go(frame);
    state.select(entity);
  };
  return button(text, press, { class: "link", title: `Go to frame ${frame}`, "data-frame": frame });
}
