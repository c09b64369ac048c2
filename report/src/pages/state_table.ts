// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { DEGREES, rotationVector } from "../math/rotation.ts";
import type { PoseTrack, Trace } from "../trace/trace.ts";
import { element } from "../ui/dom.ts";

const EVERY = 120;
const COLUMNS = ["", "x [m]", "y [m]", "z [m]", "rotation vector [deg]", "status", "hypotheses", "on the right mode"];

const percent = (share: number | undefined) => (share === undefined ? "–" : `${(100 * share).toFixed(1)} %`);

/** Numbers of camera and objects at the shown frame. While playing, it is updated a few times a second. */
export class StateTable {
  readonly node: HTMLElement;
  private readonly rows: HTMLTableRowElement[] = [];
  private readonly p = [0, 0, 0];
  private readonly q = [0, 0, 0, 1];
  private readonly r = [0, 0, 0];
  private last = -Infinity;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private frame = 0;

  constructor(private readonly trace: Trace) {
    const columns = trace.hasTracks ? [...COLUMNS, "exists", "track"] : COLUMNS;
    const head = element("tr", {}, ...columns.map((name) => element("th", { scope: "col" }, name)));
    const body = element("tbody");
    for (const name of ["camera", ...trace.objects.map(({ id }) => id)]) {
      const row = element("tr", {}, element("th", { scope: "row" }, name), ...columns.slice(1).map(() => element("td", { class: "number" })));
      this.rows.push(row);
      body.append(row);
    }
    const made = element("table", { id: "state" }, element("caption", {}, "In the world, at this frame"), element("thead", {}, head), body);
    const scroll = element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Poses at this frame" }, made);
    this.node = element("details", { open: innerWidth > 700 }, element("summary", {}, "Poses at this frame"), scroll);
    this.node.addEventListener("toggle", () => this.write());
  }

  update(frame: number): void {
    this.frame = frame;
    const wait = this.last + EVERY - performance.now();
    if (wait <= 0) this.write();
    else this.timer ??= setTimeout(() => this.write(), wait);
  }

  private write(): void {
    clearTimeout(this.timer);
    this.timer = undefined;
    this.last = performance.now();
    if (!(this.node as HTMLDetailsElement).open) return;
    const { camera, objects, cameraHypotheses } = this.trace;
    this.writePose(this.rows[0], camera?.pose);
    this.set(this.rows[0], 6, cameraHypotheses.length > 0 ? this.living(-1) : "");
    objects.forEach((object, i) => {
      const row = this.rows[i + 1];
      this.writePose(row, object.world?.pose);
      this.set(row, 5, object.status ? (this.trace.statuses[object.status[this.frame]] ?? "") : "");
      this.set(row, 6, this.living(i));
      const mode = object.modeProbability?.(this.frame);
      this.set(row, 7, percent(mode));
      if (!this.trace.hasTracks) return;
      this.set(row, 8, percent(object.existence?.(this.frame)));
      this.set(row, 9, this.trackText(i));
    });
  }

  private trackText(index: number): string {
    const again = this.trace.objects[index].registerAgain?.[this.frame] ? ", register again" : "";
    return (this.trace.healthAt(index, this.frame) || "–") + again;
  }

  /** The weights of the hypotheses in this frame, the heaviest first. */
  private living(index: number): string {
    const slots = index < 0 ? this.trace.cameraHypotheses : this.trace.objects[index].hypotheses;
    const weights = slots.filter((slot) => slot.pose.has(this.frame)).map((slot) => slot.probability(this.frame));
    const shown = weights.sort((a, b) => b - a).slice(0, 3).map((weight) => (100 * weight).toFixed(weight < 0.01 ? 2 : 0));
    return weights.length === 0 ? "–" : `${weights.length}: ${shown.join(", ")}${weights.length > 3 ? ", …" : ""} %`;
  }

  private writePose(row: HTMLTableRowElement, track: PoseTrack | undefined): void {
    if (!track?.has(this.frame)) {
      for (let i = 1; i <= 4; ++i) this.set(row, i, "–");
      return;
    }
    track.position(this.frame, this.p);
    track.quaternion(this.frame, this.q);
    if (this.q[3] < 0) for (let i = 0; i < 4; ++i) this.q[i] = -this.q[i];
    rotationVector(this.q, this.r);
    for (let i = 0; i < 3; ++i) this.set(row, i + 1, this.p[i].toFixed(4));
    this.set(row, 4, this.r.map((angle) => (angle * DEGREES).toFixed(1)).join(", "));
  }

  private set(row: HTMLTableRowElement, cell: number, text: string): void {
    const node = row.cells[cell];
    if (node.textContent !== text) node.textContent = text;
  }
}
