// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The first tab: what a run came to, in sentences, and a card for the camera and every object.
import type { Json } from "../payload.ts";
import type { PoseDisplay } from "../state/pose_display.ts";
import type { RunFacts } from "../state/run_facts.ts";
import { CAMERA, type Entity, type RunState } from "../state/run_state.ts";
import { BAD_KINDS, durationOf, type EventKind, type RunEvent } from "../trace/events.ts";
import { cameraSentence, detectorSentence, durationSentence } from "../trace/summary.ts";
import type { Level } from "../trace/verdict.ts";
import { button, element } from "../ui/dom.ts";
import { momentLink } from "../ui/links.ts";
import { plural, short, time } from "../ui/numbers.ts";
import { ObjectCard, SIGNS } from "./object_card.ts";

/** Texts of cards are written a few times a second. */
const EVERY = 100;
const SEVERITY: readonly Level[] = ["bad", "fair", "none", "good"];

/** One kind of trouble of an object: how often and when. */
function trouble(state: RunState, kind: EventKind, events: readonly RunEvent[]): (Node | string)[] {
  const worst = events.reduce((a, b) => (b.size > a.size ? b : a));
  const count = events.reduce((sum, event) => sum + event.count, 0);
  const last = events[events.length - 1];
  const length = events.reduce((sum, event) => sum + durationOf(state.trace, event), 0);
  const at = (frame: number) => momentLink(state, frame, worst.entity);
  switch (kind) {
    case "flipped":
      return [`flipped or jumped ${count === 1 ? "once, at " : `${count} times, the last at `}`, at(last.peak)];
    case "lost":
      return [`lost for ${time(length)}, first at `, at(events[0].from)];
    case "register":
      return ["should be registered again from ", at(events[0].from), " on"];
    case "unexplained":
      return [`${events.length === 1 ? "a run" : `${events.length} runs`} of ${plural(count, "detection")} not explained, ${events.length === 1 ? "" : "the longest "}at `, at(worst.from)];
    case "beyond":
      return [`error beyond 3 sigma in ${plural(count, "frame")}, most at `, at(worst.peak), ` (${short(worst.size)} sigma)`];
    default:
      return [`NEES beyond its 99.9 % band in ${plural(count, "frame")}, most at `, at(worst.peak), ` (${short(worst.size)})`];
  }
}

/** What went wrong, an item per object. */
function troubles(state: RunState, facts: RunFacts, order: readonly Entity[]): HTMLElement {
  const list = element("ul", { class: "troubles" });
  for (const entity of order) {
    const events = facts.eventsOfEntity(entity);
    const isBeyond = events.some(({ kind }) => kind === "beyond");
    const parts = [...BAD_KINDS].flatMap((kind) => {
      // Both tell of the same errors, and one is enough for a summary.
      const own = events.filter((event) => event.kind === kind && !(kind === "nees" && isBeyond));
      return own.length > 0 ? [trouble(state, kind, own)] : [];
    });
    if (parts.length === 0) continue;
    const item = element("li", {}, button(state.nameOf(entity), () => state.select(entity), { class: "link strong" }), ": ");
    parts.forEach((part, k) => item.append(...(k > 0 ? ["; "] : []), ...part));
    item.append(".");
    list.append(item);
  }
  if (list.childElementCount > 0) return element("div", {}, element("h2", {}, "What went wrong"), list);
  const truth = state.trace.hasTruth ? ", and no error is beyond 3 sigma for longer than chance" : "";
  return element("p", {}, `Nothing went wrong that the trace shows: no flip, no lost object, no run of detections that are not explained${truth}.`);
}

/** Consistency of all poses, the worst first. */
function verdicts(facts: RunFacts, state: RunState, order: readonly Entity[]): HTMLElement {
  const sorted = order.map((entity) => ({ entity, ...facts.verdict(entity) })).sort((a, b) => SEVERITY.indexOf(a.level) - SEVERITY.indexOf(b.level));
  const node = element("p", {}, `Covariances beside ${state.trace.hasTruth ? "errors" : "innovations"}: `);
  for (const word of new Set(sorted.map((one) => one.word))) {
    const own = sorted.filter((one) => one.word === word);
    const names = own.length === order.length && order.length > 2 ? "camera and all objects" : own.map(({ entity }) => state.nameOf(entity)).join(", ");
    node.append(node.childElementCount > 0 ? "; " : "", element("span", { class: `verdict ${own[0].level}` }, `${SIGNS[own[0].level]} ${word}`), `: ${names}`);
  }
  node.append(".");
  return node;
}

/** Without ground truth: what the filter says of itself at the end. */
function spreadSentence(state: RunState): string {
  const { trace } = state;
  const sd = [0, 0, 0];
  const widest = (entity: Entity) => {
    const estimate = entity < 0 ? trace.camera : trace.objects[entity].world;
    if (!estimate?.hasPositionSd || !estimate.pose.has(trace.frames - 1)) return NaN;
    estimate.positionSdAt(trace.frames - 1, sd);
    return 3000 * Math.max(...sd);
  };
  const objects = trace.objects.map((_, i) => widest(i)).filter((value) => !Number.isNaN(value));
  const camera = widest(CAMERA);
  const parts = [
    ...(Number.isNaN(camera) ? [] : [`the camera within ${short(camera)} mm`]),
    ...(objects.length > 0 ? [`the objects within ${short(Math.max(...objects))} mm`] : []),
  ];
  const end = parts.length > 0 ? ` By its own covariances the filter has, at the end and with 3 sigma, ${parts.join(" and ")}.` : "";
  return `There is no ground truth, so errors are not known.${end}`;
}

function summary(state: RunState, facts: RunFacts, metrics: Json | undefined, order: readonly Entity[]): HTMLElement {
  const { trace } = state;
  const sentences = trace.hasTruth ? [cameraSentence(metrics), detectorSentence(metrics)] : [spreadSentence(state)];
  return element("div", { class: "summary", "data-print": "" },
    ...[durationSentence(trace), ...sentences].filter((text) => text !== undefined).map((text) => element("p", {}, text)),
    verdicts(facts, state, order), troubles(state, facts, order));
}

export interface Overview {
  node: HTMLElement;
  /** Called whenever the tab is opened. */
  open: () => void;
}

export function overview(state: RunState, facts: RunFacts, display: PoseDisplay, metrics: Json | undefined): Overview {
  const order: Entity[] = [...facts.byDoubt, CAMERA];
  const cards = order.map((entity) => new ObjectCard(state, facts, display, entity));
  const node = element("div", { class: "overview" }, summary(state, facts, metrics, order),
    element("p", { class: "hint" }, "Most uncertain object first; values are those at the playhead. A press on a card selects."),
    element("div", { class: "cards" }, ...cards.map((card) => card.node)));
  let timer: ReturnType<typeof setTimeout> | undefined;
  let last = 0;
  const update = () => {
    timer = undefined;
    last = performance.now();
    if (!node.closest("[hidden]")) for (const card of cards) card.update();
  };
  state.on("frame", () => (timer ??= setTimeout(update, Math.max(0, last + EVERY - performance.now()))));
  display.on(update);
  state.on("selection", () => cards.forEach((card) => card.markSelected()));
  return { node, open: update };
}
