// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The events of a run as a list: a press goes to the moment and selects the object.
import type { EventChoice } from "../state/event_choice.ts";
import type { RunFacts } from "../state/run_facts.ts";
import type { RunState } from "../state/run_state.ts";
import { BAD_KINDS, describe, durationOf, EVENT_KINDS, type EventKind, type RunEvent } from "../trace/events.ts";
import { choice, element, toggle } from "../ui/dom.ts";
import { momentLink } from "../ui/links.ts";
import { fixed, plural } from "../ui/numbers.ts";
import { colourOf } from "../ui/palette.ts";

function rowOf(state: RunState, event: RunEvent): HTMLTableRowElement {
  const { kind, entity, from, to } = event;
  const { trace } = state;
  const isBad = BAD_KINDS.has(kind);
  const name = element("span", { class: "object" }, state.nameOf(entity));
  if (entity >= 0) name.style.setProperty("--swatch", colourOf(entity));
  const row = element("tr", { class: isBad ? "bad" : "", "data-kind": kind, "data-entity": state.nameOf(entity), "data-from": from, "data-to": to },
    element("td", { class: "number" }, momentLink(state, from, entity, `${fixed(trace.seconds[from], 2)} s`)), element("td", { class: "number" }, to > from ? `${fixed(durationOf(trace, event), 2)} s` : ""),
    element("td", {}, name), element("td", { class: "what", title: EVENT_KINDS[kind] }, ...(isBad ? [element("span", { class: "sign", "aria-hidden": "true" }, "✗ ")] : []), describe(trace, event)));
  row.addEventListener("click", (press) => {
    if ((press.target as HTMLElement).closest("button")) return;
    state.go(from);
    state.select(entity);
  });
  return row;
}

export interface EventsList {
  node: HTMLElement;
  open: () => void;
}

export function eventsList(state: RunState, facts: RunFacts, events: EventChoice): EventsList {
  const body = element("tbody");
  const count = element("span", { class: "hint", role: "status" });
  const rows = new Map(facts.events.map((event) => [event, rowOf(state, event)]));
  const fill = () => {
    const shown = events.events;
    count.textContent = `${plural(shown.length, "event")}${shown.length < rows.size ? ` of ${rows.size}` : ""}. Keys: n next, p previous, with shift of the selected object.`;
    body.replaceChildren(...shown.map((event) => rows.get(event)!));
  };
  const mark = () => {
    if (body.closest("[hidden]")) return;
    for (const [{ from, to }, row] of rows) row.classList.toggle("now", from <= state.frame && state.frame <= to);
  };
  events.on(fill);
  state.on("frame", mark);
  fill();
  const present = new Set(facts.events.map(({ kind }) => kind));
  const kinds = (Object.keys(EVENT_KINDS) as EventKind[]).filter((kind) => present.has(kind));
  const entities = [...new Set(facts.events.map(({ entity }) => entity))].sort((a, b) => a - b);
  const of = choice("Object", [["", "all"], ...entities.map((entity) => [String(entity), state.nameOf(entity)] as const)], "",
    (value) => events.setEntity(value === "" ? undefined : Number(value)));
  const boxes = element("div", { class: "toggles", role: "group", "aria-label": "Kinds of events" },
    ...kinds.map((kind) => toggle(EVENT_KINDS[kind], true, (on) => events.setKind(kind, on))));
  const head = element("tr", {}, ...["time", "for", "object", "what"].map((name) => element("th", { scope: "col" }, name)));
  const made = element("table", { class: "events" }, element("caption", {}, "Events"), element("thead", {}, head), body);
  const node = element("div", {}, element("div", { class: "controls" }, of, boxes), element("p", {}, count),
    element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Events" }, made));
  return { node, open: mark };
}
