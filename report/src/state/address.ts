// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The state in the address of the page, #t=20.7&object=mug&tab=errors, so that a moment can be sent.
import type { RunState, Topic } from "./run_state.ts";

const TOPICS: readonly Topic[] = ["frame", "selection", "visibility", "follow", "tab", "view"];
/** Browsers refuse addresses that change too often. */
const LEAST_PAUSE_MS = 300;

/** The part of the address after #; what is as at the beginning is left out. */
export function addressOf(state: RunState, initial: { object: number; tab: string; view: string }): string {
  const parts = new URLSearchParams();
  if (state.frame !== 0) parts.set("t", String(Number(state.seconds.toFixed(4))));
  if (state.selected !== initial.object) parts.set("object", state.nameOf(state.selected));
  if (state.tab !== initial.tab) parts.set("tab", state.tab.toLowerCase());
  if (state.view !== initial.view) parts.set("view", state.view);
  for (const entity of state.hidden) parts.append("hide", state.nameOf(entity));
  if (state.follow) parts.set("follow", "1");
  return parts.toString();
}

/** Takes a state from an address; what it does not know is left as it is. */
export function readAddress(state: RunState, address: string): void {
  const parts = new URLSearchParams(address.replace(/^#/, ""));
  const seconds = Number(parts.get("t") ?? NaN);
  // Addresses have rounded times, and the frame before would be another one.
  if (Number.isFinite(seconds)) state.seek(seconds + 1e-4);
  const object = state.entityOf(parts.get("object") ?? "");
  if (object !== undefined) state.select(object);
  const hidden = new Set(parts.getAll("hide"));
  state.trace.objects.forEach(({ id }, i) => state.setHidden(i, hidden.has(id)));
  state.setFollow(parts.get("follow") === "1");
  const view = parts.get("view");
  if (view !== null) state.setView(view);
  const tab = parts.get("tab");
  if (tab !== null) state.setTab(tab);
}

/** Keeps the address as the state is, and the state as an address that is entered. */
export function bindAddress(state: RunState): void {
  const initial = { object: state.selected, tab: state.tab, view: state.view };
  if (location.hash.length > 1) readAddress(state, location.hash);
  let timer: ReturnType<typeof setTimeout> | undefined;
  const write = () => {
    timer = undefined;
    const address = addressOf(state, initial);
    history.replaceState(null, "", address === "" ? location.pathname + location.search : `#${address}`);
  };
  for (const topic of TOPICS) state.on(topic, () => (timer ??= setTimeout(write, LEAST_PAUSE_MS)));
  addEventListener("hashchange", () => readAddress(state, location.hash));
}
