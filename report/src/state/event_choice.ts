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
  private readonly listeners = new Set<() => void>();

  constructor(private readonly state: RunState, private readonly facts: RunFacts) {}

  on(change: () => void): void {
    this.listeners.add(change);
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

  /** Goes to the next (1) or previous (-1) frame at which an event begins, and selects its object. */
  step(by: 1 | -1, onlySelected: boolean): void {
    const { state } = this;
    const events = this.events.filter(({ entity }) => !onlySelected || entity === state.selected);
    const found = by > 0 ? events.find(({ from }) => from > state.frame) : events.filter(({ from }) => from < state.frame).at(-1);
    if (!found) return;
    // Of several that begin at one frame, the first.
    const event = events.find(({ from }) => from === found.from)!;
    state.go(event.from);
    state.select(event.entity);
  }

  /** The event that began last at or before a frame and still lasts there. */
  at(frame: number): RunEvent | undefined {
    let found: RunEvent | undefined;
    for (const event of this.events) if (event.from <= frame && frame <= event.to) found = event;
    return found;
  }
}
