// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What of a run is shown: the frame, the selected object, the tab. Every part of the page reads and changes it here.
import type { Trace } from "../trace/trace.ts";

/** The number of an object, or CAMERA. */
export type Entity = number;
export const CAMERA: Entity = -1;

/** What may change; listeners are told of one of these. */
export type Topic = "frame" | "selection" | "visibility" | "follow" | "tab" | "view";

export class RunState {
  private shownFrame = 0;
  private chosen: Entity;
  private openTab = "";
  private lookFrom = "fit";
  private following = false;
  private readonly hiddenObjects = new Set<Entity>();
  private readonly listeners = new Map<Topic, Set<() => void>>();

  constructor(readonly trace: Trace, first: Entity = 0) {
    this.chosen = trace.objects.length > 0 ? first : CAMERA;
  }

  on(topic: Topic, listener: () => void): void {
    const set = this.listeners.get(topic) ?? new Set();
    this.listeners.set(topic, set.add(listener));
  }

  private tell(topic: Topic): void {
    for (const listener of this.listeners.get(topic) ?? []) listener();
  }

  get frame(): number {
    return this.shownFrame;
  }

  /** Seconds since the first frame. */
  get seconds(): number {
    return this.trace.seconds[this.shownFrame];
  }

  /** Shows a frame; one that is out of range is the nearest there is. */
  go(frame: number): void {
    const next = Math.max(0, Math.min(this.trace.frames - 1, Math.round(frame)));
    if (next === this.shownFrame || Number.isNaN(next)) return;
    this.shownFrame = next;
    this.tell("frame");
  }

  seek(seconds: number): void {
    this.go(this.trace.frameAt(seconds));
  }

  /** The selected object, or CAMERA. */
  get selected(): Entity {
    return this.chosen;
  }

  select(entity: Entity): void {
    if (entity === this.chosen || entity < CAMERA || entity >= this.trace.objects.length) return;
    this.chosen = entity;
    this.tell("selection");
  }

  /** The id of an object, or the camera's name, which no object has. */
  nameOf(entity: Entity): string {
    return entity === CAMERA ? this.trace.cameraName : this.trace.objects[entity].id;
  }

  /** What has a name; undefined if nothing has. */
  entityOf(name: string): Entity | undefined {
    const index = this.trace.objects.findIndex(({ id }) => id === name);
    if (index >= 0) return index;
    return name === this.trace.cameraName ? CAMERA : undefined;
  }

  /** The objects that are hidden in the scene. */
  get hidden(): ReadonlySet<Entity> {
    return this.hiddenObjects;
  }

  setHidden(entity: Entity, hide: boolean): void {
    if (this.hiddenObjects.has(entity) === hide) return;
    if (hide) this.hiddenObjects.add(entity);
    else this.hiddenObjects.delete(entity);
    this.tell("visibility");
  }

  /** Hides all objects but one; all are shown where it was alone already. */
  solo(entity: Entity): void {
    const others = this.trace.objects.map((_, i) => i).filter((i) => i !== entity);
    const isAlone = !this.hiddenObjects.has(entity) && others.every((i) => this.hiddenObjects.has(i));
    this.hiddenObjects.clear();
    if (!isAlone) for (const other of others) this.hiddenObjects.add(other);
    this.tell("visibility");
  }

  /** Whether the scene's view moves with the selected object. */
  get follow(): boolean {
    return this.following;
  }

  setFollow(on: boolean): void {
    if (on === this.following) return;
    this.following = on;
    this.tell("follow");
  }

  /** The name of the open tab. */
  get tab(): string {
    return this.openTab;
  }

  setTab(name: string): void {
    if (name === this.openTab) return;
    this.openTab = name;
    this.tell("tab");
  }

  /** The view of the scene, as the buttons name it. */
  get view(): string {
    return this.lookFrom;
  }

  setView(name: string): void {
    if (name === this.lookFrom) return;
    this.lookFrom = name;
    this.tell("view");
  }
}
