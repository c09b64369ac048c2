// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The state in the address of the page, #t=20.7&object=mug&tab=errors, so that a moment can be sent.
import { isView } from "../scene/views.ts";
import { CAMERA, type Entity, type RunState, type Topic } from "./run_state.ts";
import type { OneOf } from "./setting.ts";

const TOPICS: readonly Topic[] = ["frame", "selection", "visibility", "follow", "tab", "view"];
/** Browsers refuse addresses that change too often. */
const LEAST_PAUSE_MS = 300;

/** What an address does not name is as it is at the beginning. */
export interface Beginning {
  object: Entity;
  tab: string;
  view: string;
}

/** Settings of the page that are in the address, by their names there. */
export type Kept = Readonly<Record<string, OneOf<string>>>;

/** The part of the address after #; what is as at the beginning is left out. */
export function addressOf(state: RunState, initial: Beginning, kept: Kept = {}): string {
  const parts = new URLSearchParams();
  if (state.frame !== 0) parts.set("t", String(Number(state.seconds.toFixed(4))));
  if (state.selected !== initial.object) parts.set("object", state.nameOf(state.selected));
  if (state.tab !== initial.tab) parts.set("tab", state.tab.toLowerCase());
  if (state.view !== initial.view) parts.set("view", state.view);
  for (const entity of state.hidden) parts.append("hide", state.nameOf(entity));
  if (state.follow) parts.set("follow", "1");
  for (const [name, { value, first }] of Object.entries(kept)) if (value !== first) parts.set(name, value);
  return parts.toString();
}

/** Opens a tab by its name in small letters; the first one where there is no such tab. */
function openTab(state: RunState, name: string, first: string): void {
  if (name === state.tab.toLowerCase()) return;
  state.setTab(name);
  // A tab that opens puts its own name, which has a capital.
  if (state.tab === name) state.setTab(first);
}

/** Takes the whole state from an address, so that it shows what it showed to its sender; what the page does not know is as at the beginning. */
export function readAddress(state: RunState, address: string, initial: Beginning, kept: Kept = {}): void {
  const parts = new URLSearchParams(address.replace(/^#/, ""));
  const seconds = Number(parts.get("t") ?? NaN);
  // Addresses have rounded times, and the frame before would be another one.
  state.seek(Number.isFinite(seconds) ? seconds + 1e-4 : 0);
  state.select(state.entityOf(parts.get("object") ?? "") ?? initial.object);
  const hidden = new Set(parts.getAll("hide"));
  for (let entity = CAMERA; entity < state.trace.objects.length; ++entity) state.setHidden(entity, hidden.has(state.nameOf(entity)));
  state.setFollow(parts.get("follow") === "1");
  const view = parts.get("view") ?? "";
  state.setView(isView(view) ? view : initial.view);
  for (const [name, setting] of Object.entries(kept)) setting.take(parts.get(name));
  openTab(state, (parts.get("tab") ?? initial.tab).toLowerCase(), initial.tab);
}

/** Keeps the address as the state is, and the state as an address that is entered. */
export function bindAddress(state: RunState, kept: Kept = {}): void {
  const initial = { object: state.selected, tab: state.tab, view: state.view };
  if (location.hash.length > 1) readAddress(state, location.hash, initial, kept);
  let known = location.hash;
  let timer: ReturnType<typeof setTimeout> | undefined;
  const write = () => {
    timer = undefined;
    // An address was entered, and its event is on its way: the state before must not be written over it.
    if (location.hash !== known) return;
    const address = addressOf(state, initial, kept);
    history.replaceState(null, "", address === "" ? location.pathname + location.search : `#${address}`);
    known = location.hash;
  };
  const later = () => void (timer ??= setTimeout(write, LEAST_PAUSE_MS));
  for (const topic of TOPICS) state.on(topic, later);
  for (const setting of Object.values(kept)) setting.onChange(later);
  addEventListener("hashchange", () => {
    known = location.hash;
    readAddress(state, known, initial, kept);
  });
}
