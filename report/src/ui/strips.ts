// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Above the timeline: how sure the filter is of every object's mode, a strip each, with marks of events.
import type { EventChoice } from "../state/event_choice.ts";
import type { Entity, RunState } from "../state/run_state.ts";
import { BAD_KINDS, describe } from "../trace/events.ts";
import { leastByPixel } from "../trace/sureness.ts";
import { element } from "./dom.ts";
import { fixed, plural } from "./numbers.ts";
import { colourOf, faded } from "./palette.ts";
import { onTheme, themeColour } from "./theme.ts";

/** Height of all strips together at most, and of one [px]. */
const MOST_HEIGHT = 72;
const [LEAST_ROW, MOST_ROW] = [3, 9];
const GAP = 1;

export class Strips {
  private readonly canvas = element("canvas", { role: "img" });
  private readonly playhead = element("span", { class: "playhead" });
  private readonly said = element("output", { class: "now" });
  private readonly box: HTMLElement;
  private width = 0;

  constructor(private readonly state: RunState, private readonly events: EventChoice, place: HTMLElement) {
    this.box = element("div", { class: "bands" }, this.canvas, this.playhead);
    place.append(this.said, this.box);
    this.canvas.style.height = `${this.height}px`;
    this.canvas.addEventListener("click", (event) => this.press(event));
    this.canvas.addEventListener("mousemove", (event) => (this.canvas.title = this.nameAt(event)));
    new ResizeObserver(() => {
      if (this.canvas.clientWidth !== this.width) this.draw();
    }).observe(this.canvas);
    onTheme(() => this.draw());
    events.on(() => (this.draw(), this.update()));
    state.on("frame", () => this.update());
    events.onStep(() => this.update());
    state.on("selection", () => (this.draw(), this.update()));
    this.update();
  }

  private get row(): number {
    const count = Math.max(1, this.state.trace.objects.length);
    return Math.max(LEAST_ROW, Math.min(MOST_ROW, Math.floor(MOST_HEIGHT / count) - GAP));
  }

  private get height(): number {
    return this.state.trace.objects.length * (this.row + GAP);
  }

  private objectAt(event: MouseEvent): Entity {
    const y = event.clientY - this.canvas.getBoundingClientRect().top;
    return Math.max(0, Math.min(this.state.trace.objects.length - 1, Math.floor(y / (this.row + GAP))));
  }

  private nameAt(event: MouseEvent): string {
    return `${this.state.nameOf(this.objectAt(event))}: mode probability over time`;
  }

  private press(event: MouseEvent): void {
    const box = this.canvas.getBoundingClientRect();
    const { state } = this;
    state.go(((event.clientX - box.left) / box.width) * (state.trace.frames - 1));
    state.select(this.objectAt(event));
  }

  private draw(): void {
    const { canvas, state, row } = this;
    const { trace } = state;
    this.width = canvas.clientWidth;
    const context = canvas.getContext("2d");
    if (!context || this.width === 0) return;
    const ratio = devicePixelRatio;
    [canvas.width, canvas.height] = [Math.round(this.width * ratio), Math.round(this.height * ratio)];
    context.scale(ratio, ratio);
    trace.objects.forEach((_, i) => {
      const top = i * (row + GAP);
      const least = leastByPixel(trace, i, this.width);
      context.fillStyle = faded(colourOf(i), state.selected === i ? 0.3 : 0.18);
      least.forEach((value, x) => {
        if (!Number.isNaN(value)) context.fillRect(x, top, 1, row);
      });
      context.fillStyle = colourOf(i);
      least.forEach((value, x) => {
        if (value > 0) context.fillRect(x, top + (1 - value) * row, 1, value * row);
      });
    });
    this.drawMarks(context);
    const bad = this.events.events.filter(({ kind }) => BAD_KINDS.has(kind)).length;
    canvas.setAttribute("aria-label", `Mode probability of ${plural(trace.objects.length, "object")} over time, with ${plural(bad, "mark")} of what went wrong; the tab Events lists them.`);
  }

  /** What went wrong, in the colour of the text with the paper around it, so that it is seen on every strip. */
  private drawMarks(context: CanvasRenderingContext2D): void {
    const { frames } = this.state.trace;
    const [ink, paper] = [themeColour("--ink"), themeColour("--paper")];
    for (const { kind, entity, from } of this.events.events) {
      if (entity < 0 || !BAD_KINDS.has(kind)) continue;
      const x = (from / Math.max(1, frames - 1)) * this.width;
      const top = entity * (this.row + GAP);
      context.fillStyle = paper;
      context.fillRect(x - 1.5, top, 4, this.row);
      context.fillStyle = ink;
      context.fillRect(x - 0.5, top, 2, this.row);
    }
  }

  private update(): void {
    const { frame, trace } = this.state;
    this.playhead.style.left = `${((100 * frame) / Math.max(1, trace.frames - 1)).toFixed(3)}%`;
    const event = this.events.at(frame);
    const count = this.events.events.length;
    const text = event ? `${this.state.nameOf(event.entity)}: ${describe(trace, event)}` : `${plural(count, "event")}; n and p go to the next and the previous`;
    if (this.said.textContent !== text) this.said.textContent = text;
    this.said.classList.toggle("event", event !== undefined);
    this.said.title = event ? `from ${fixed(trace.seconds[event.from], 2)} s to ${fixed(trace.seconds[event.to], 2)} s` : "";
  }
}
