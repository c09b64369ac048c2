// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The first tab: what a run came to, in sentences, and a card for the camera and every object.
import type { Json } from "../payload.ts";
import type { PoseDisplay } from "../state/pose_display.ts";
import type { RunFacts } from "../state/run_facts.ts";
import { CAMERA, type Entity, type RunState } from "../state/run_state.ts";
import { type Deviation, framesBeyond } from "../trace/deviation.ts";
import { BAD_KINDS, durationOf, type EventKind, type RunEvent, UNSURE_KINDS } from "../trace/events.ts";
import { cameraSentence, detectorSentence, durationSentence } from "../trace/summary.ts";
import type { Level } from "../trace/verdict.ts";
import { button, element } from "../ui/dom.ts";
import { momentLink } from "../ui/links.ts";
import { plural, short, time } from "../ui/numbers.ts";
import { ObjectCard, SIGNS } from "./object_card.ts";

/** Texts of cards are written a few times a second. */
const EVERY = 100;
const SEVERITY: readonly Level[] = ["bad", "fair", "none", "good"];

type Parts = (Node | string)[];

/** "from 21.50 s to 23.40 s"; "on" where it lasts to the end. */
function spanText(state: RunState, { from, to, entity }: RunEvent): Parts {
  const isOpen = to === state.trace.frames - 1;
  return ["from ", momentLink(state, from, entity), ...(isOpen ? [" on"] : [" to ", momentLink(state, to, entity)])];
}

/** All frames beyond 3 sigma, also those that make no event. */
function beyondText(state: RunState, facts: RunFacts, entity: Entity): Parts {
  const { frame, size } = facts.worst(entity)!;
  return [`error beyond 3 sigma in ${plural(framesBeyond(facts.deviation(entity)!), "frame")}, most at `, momentLink(state, frame, entity), ` (${short(size)} sigma)`];
}

/** One kind of trouble of an object: how often and when. */
function trouble(state: RunState, facts: RunFacts, kind: EventKind, events: readonly RunEvent[]): Parts {
  const worst = events.reduce((a, b) => (b.size > a.size ? b : a));
  const count = events.reduce((sum, event) => sum + event.count, 0);
  const last = events[events.length - 1];
  const length = time(events.reduce((sum, event) => sum + durationOf(state.trace, event), 0));
  const at = (frame: number) => momentLink(state, frame, worst.entity);
  const lasting = (words: string): Parts => [`${words} for ${length}, first at `, at(events[0].from)];
  switch (kind) {
    case "wrong":
      return lasting("on the wrong mode");
    case "lost":
    case "ambiguous":
      return lasting(kind);
    case "unknown":
      return [`its ${worst.detail!.replace(" not", " is not")} (3 sigma) at worst, at `, at(worst.peak)];
    case "flipped":
      return [`flipped or jumped ${count === 1 ? "once, at " : `${count} times, the last at `}`, at(last.peak)];
    case "register":
      return [`should be registered again ${events.length === 1 ? "" : `${events.length} times, first `}`, ...spanText(state, events[0])];
    case "unexplained":
      return [`${events.length === 1 ? "a run of " : `${events.length} runs, `}${plural(count, "detection")}${events.length === 1 ? "" : " in all,"} not explained, ${events.length === 1 ? "" : "the longest "}at `, at(worst.from)];
    case "beyond":
      return beyondText(state, facts, worst.entity);
    default:
      return [`NEES beyond its 99.9 % band in ${plural(count, "frame")}, most at `, at(worst.peak), ` (${short(worst.size)})`];
  }
}

/** The kinds that are told of one pose. */
function kindsOf(events: readonly RunEvent[]): EventKind[] {
  const has = (kind: EventKind) => events.some((event) => event.kind === kind);
  // Both tell of the same errors, and one is enough for a summary.
  return [...BAD_KINDS, ...UNSURE_KINDS].filter((kind) => has(kind) && !(kind === "nees" && has("beyond")));
}

/** How bad it went, the first number first: on a wrong mode, the largest error in sigmas, faults without a size. */
function severity(facts: RunFacts, entity: Entity): number[] {
  const events = facts.eventsOfEntity(entity);
  const has = (kind: EventKind) => Number(events.some((event) => event.kind === kind));
  const { of, size } = facts.worst(entity) ?? { of: "spread", size: 0 };
  return [has("wrong"), of === "error" && has("beyond") ? size : 0, has("lost") + has("register"), has("flipped"), has("unexplained")];
}

function bySeverity(facts: RunFacts, order: readonly Entity[]): Entity[] {
  const ranks = new Map(order.map((entity) => [entity, severity(facts, entity)]));
  const compare = (a: Entity, b: Entity) => ranks.get(b)!.map((rank, k) => rank - ranks.get(a)![k]).find((difference) => difference !== 0) ?? 0;
  return [...order].sort(compare);
}

/** Of a run without troubles; errors that are beyond 3 sigma are told, however few. */
function calmText(facts: RunFacts, order: readonly Entity[], hasTruth: boolean): string {
  const nothing = "no flip, no lost object, no run of detections that are not explained";
  if (!hasTruth) return `Nothing went wrong that the trace shows: ${nothing}.`;
  const deviations = order.map((entity) => facts.deviation(entity)).filter((deviation) => deviation !== undefined);
  const sum = (of: (deviation: Deviation) => number) => deviations.reduce((total, deviation) => total + of(deviation), 0);
  const [beyond, frames] = [sum(framesBeyond), sum((deviation) => deviation.frames)];
  if (beyond === 0) return `Nothing went wrong that the trace shows: ${nothing}, no wrong mode, and no error is beyond 3 sigma.`;
  return `The trace shows ${nothing} and no wrong mode. Errors are beyond 3 sigma in ${beyond} of ${frames} poses, but never for long.`;
}

/** What went wrong, an item per object, the worst first. */
function troubles(state: RunState, facts: RunFacts, order: readonly Entity[]): HTMLElement {
  const list = element("ul", { class: "troubles" });
  const told = new Set<EventKind>();
  for (const entity of bySeverity(facts, order)) {
    const events = facts.eventsOfEntity(entity);
    const kinds = kindsOf(events);
    if (kinds.length === 0) continue;
    const item = element("li", {}, button(state.nameOf(entity), () => state.select(entity), { class: "link strong" }), ": ");
    kinds.forEach((kind, k) => item.append(...(k > 0 ? ["; "] : []), ...trouble(state, facts, kind, events.filter((event) => event.kind === kind))));
    item.append(".");
    list.append(item);
    for (const kind of kinds) told.add(kind);
  }
  if (told.size === 0) return element("p", {}, calmText(facts, order, state.trace.hasTruth));
  const isFault = [...told].some((kind) => BAD_KINDS.has(kind));
  return element("div", {}, element("h2", {}, isFault ? "What went wrong" : "What was not known"), list);
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
