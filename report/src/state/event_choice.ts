// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Which events are listed, marked and stepped through.
import type { EventKind, RunEvent } from "../trace/events.ts";
import type { RunFacts } from "./run_facts.ts";
import type { Entity, RunState } from "./run_state.ts";

export class EventChoice {
  private readonly offKinds = new Set<EventKind>();
  private chosen: Entity | undefined;
  private shown: RunEvent[] | undefined;
  /** The event that was stepped to last. */
  private current: RunEvent | undefined;
  private readonly listeners = new Set<() => void>();
  private readonly steppers = new Set<() => void>();

  constructor(private readonly state: RunState, private readonly facts: RunFacts) {}

  on(change: () => void): void {
    this.listeners.add(change);
  }

  /** Told of every step, also of one to another event of the same frame and object. */
  onStep(step: () => void): void {
    this.steppers.add(step);
  }

  private tell(): void {
    this.shown = undefined;
    for (const listener of this.listeners) listener();
  }

  has(kind: EventKind): boolean {
    return !this.offKinds.has(kind);
  }

  setKind(kind: EventKind, on: boolean): void {
    if (on) this.offKinds.delete(kind);
    else this.offKinds.add(kind);
    this.tell();
  }

  /** The events of one object or the camera alone; undefined: of all. */
  setEntity(entity: Entity | undefined): void {
    this.chosen = entity;
    this.tell();
  }

  /** By time. */
  get events(): RunEvent[] {
    return (this.shown ??= this.facts.events.filter(({ kind, entity }) => this.has(kind) && (this.chosen === undefined || entity === this.chosen)));
  }

  /** The event that was stepped to, as long as its frame and object are shown. */
  private get stepped(): RunEvent | undefined {
    const { current, state } = this;
    return current && current.from === state.frame && current.entity === state.selected ? current : undefined;
  }

  /** Goes to the next (1) or previous (-1) event, and selects its object; of several that begin at one frame to each in turn. */
  step(by: 1 | -1, onlySelected: boolean): void {
    const { state, stepped } = this;
    const events = this.events.filter(({ entity }) => !onlySelected || entity === state.selected);
    const at = stepped ? events.indexOf(stepped) : -1;
    const next = by > 0 ? events.find(({ from }) => from > state.frame) : events.filter(({ from }) => from < state.frame).at(-1);
    const found = at >= 0 ? events[at + by] : next;
    if (!found) return;
    this.current = found;
    state.go(found.from);
    state.select(found.entity);
    for (const listener of this.steppers) listener();
  }

  /** The event that was stepped to; else of those that last at a frame the one that began last, of the selected object if it has one. */
  at(frame: number): RunEvent | undefined {
    const { stepped, state } = this;
    const lasting = this.events.filter(({ from, to }) => from <= frame && frame <= to);
    if (stepped && lasting.includes(stepped)) return stepped;
    return lasting.filter(({ entity }) => entity === state.selected).at(-1) ?? lasting.at(-1);
  }
}
