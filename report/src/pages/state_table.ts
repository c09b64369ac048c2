// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { PoseDisplay, PoseReading, rotationText, sigmaText } from "../state/pose_display.ts";
import { CAMERA, type Entity, type RunState } from "../state/run_state.ts";
import type { Trace } from "../trace/trace.ts";
import { button, element } from "../ui/dom.ts";
import { icon, setIcon } from "../ui/icons.ts";
import { openMenu } from "../ui/menu.ts";
import { fixed, percent, short } from "../ui/numbers.ts";
import { colourOf } from "../ui/palette.ts";
import { copyText, POSE_FORMS, type PoseForm, poseText } from "../ui/pose_text.ts";
import { oneOfChoice } from "../ui/setting_choice.ts";
import { MODE_PROBABILITY } from "./words.ts";

const EVERY = 120;
/** Columns of the cells after the name. */
enum Cell { x, y, z, rotation, status, hypotheses, mode, exists, track }

interface Row {
  entity: Entity;
  line: HTMLTableRowElement;
  cells: HTMLTableCellElement[];
  /** The lines of sigmas, in the cells of the pose. */
  sigmas: HTMLElement[];
  eye: HTMLButtonElement | undefined;
}

/** Numbers of camera and objects at the shown frame. While playing, it is updated a few times a second. */
export class StateTable {
  readonly node: HTMLDetailsElement;
  private readonly rows: Row[];
  private readonly reading = new PoseReading();
  private readonly caption = element("caption", { class: "unseen" });
  private readonly said = element("span", { class: "hint", role: "status" });
  private readonly trace: Trace;
  private last = -Infinity;
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly state: RunState, private readonly display: PoseDisplay) {
    this.trace = state.trace;
    this.rows = [CAMERA, ...this.trace.objects.map((_, i) => i)].map((entity) => this.makeRow(entity));
    const body = element("tbody", {}, ...this.rows.map(({ line }) => line));
    const made = element("table", { id: "state", class: "poses" }, this.caption, this.head(), body);
    const scroll = element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Poses at this frame" }, made);
    this.node = element("details", { class: "state", open: innerWidth > 700 }, element("summary", {}, "Poses at this frame"), this.controls(), scroll);
    this.node.addEventListener("toggle", () => this.write());
    state.on("selection", () => this.markSelected());
    state.on("visibility", () => this.markHidden());
    display.on(() => this.write());
    this.markSelected();
    this.markHidden();
  }

  private head(): HTMLElement {
    const unit = (name: string, text: string, below: string) =>
      element("th", { scope: "col" }, name, element("span", { class: "unit" }, ` [${text}]`), element("small", {}, below));
    const plain = (name: string, title = "") => element("th", { scope: "col", ...(title ? { title } : {}) }, name);
    const tracks = this.trace.hasTracks ? [plain("exists"), plain("track")] : [];
    return element("thead", {}, element("tr", {}, element("th", { scope: "col" }, "object"),
      ...["x", "y", "z"].map((name) => unit(name, "m", "± [mm]")), unit("rotation", "deg", "± [deg] about x, y, z"),
      plain("status"), plain("hypotheses"), plain("mode probability", MODE_PROBABILITY), ...tracks));
  }

  private controls(): HTMLElement {
    const { display } = this;
    return element("div", { class: "controls" },
      oneOfChoice("Poses in", display.reference), oneOfChoice("rotation as", display.rotation),
      element("span", { class: "hint" }, "±: 3 sigma"), this.said);
  }

  private makeRow(entity: Entity): Row {
    const { state } = this;
    const name = state.nameOf(entity);
    const count = this.trace.hasTracks ? 9 : 7;
    const cells = Array.from({ length: count }, (_, k) => element("td", { class: k < 3 ? "number" : "" }));
    const sigmas = cells.slice(0, 4).map((cell) => {
      const line = element("small");
      cell.append(element("span"), line);
      return line;
    });
    const copy = button("", () => this.offerCopy(entity, copy), { class: "small", "aria-label": `Copy the pose of ${name}`, title: "Copy this pose", "aria-haspopup": "menu" });
    copy.append(icon("copy"));
    const choose = button(name, () => state.select(entity), { class: "name" });
    if (entity >= 0) choose.style.setProperty("--swatch", colourOf(entity));
    const eye = entity < 0 ? undefined : button("", () => state.setHidden(entity, !state.hidden.has(entity)), { class: "small" });
    eye?.append(icon("eye"));
    const alone = entity < 0 ? undefined : button("", () => state.solo(entity), { class: "small", "aria-label": `Show ${name} alone, or all`, title: "Show alone, or all" });
    alone?.append(icon("alone"));
    const tools = [eye, alone, copy].filter((one) => one !== undefined);
    const line = element("tr", { "data-entity": name }, element("th", { scope: "row" }, element("span", { class: "tools" }, ...tools, choose)), ...cells);
    line.addEventListener("click", (event) => {
      if (!(event.target as HTMLElement).closest("button")) state.select(entity);
    });
    return { entity, line, cells, sigmas, eye };
  }

  private offerCopy(entity: Entity, at: HTMLElement): void {
    const estimate = this.display.estimate(this.trace, entity);
    const { frame } = this.state;
    if (!this.reading.read(estimate, frame)) {
      this.said.textContent = "There is no pose to copy at this frame.";
      return;
    }
    const pose = {
      from: this.display.of === "camera" ? this.trace.cameraName : "world", to: this.state.nameOf(entity), stamp: this.trace.head.stamps_s[frame],
      p: [...this.reading.p], q: [...this.reading.q],
    };
    const copy = async (form: PoseForm) => {
      const done = await copyText(poseText(pose, form));
      this.said.textContent = done ? `Copied ${pose.to} as ${POSE_FORMS[form]}.` : "The browser does not let this page copy.";
    };
    openMenu(at, `Copy the pose of ${pose.to} as`, (Object.keys(POSE_FORMS) as PoseForm[]).map((form) => ({ text: POSE_FORMS[form], press: () => void copy(form) })));
  }

  private markSelected(): void {
    for (const { entity, line } of this.rows) {
      if (entity === this.state.selected) line.setAttribute("aria-current", "true");
      else line.removeAttribute("aria-current");
    }
  }

  private markHidden(): void {
    for (const { entity, line, eye } of this.rows) {
      if (!eye) continue;
      const isHidden = this.state.hidden.has(entity);
      line.classList.toggle("hidden", isHidden);
      setIcon(eye.firstElementChild as SVGElement, isHidden ? "hidden" : "eye");
      const text = `${isHidden ? "Show" : "Hide"} ${this.state.nameOf(entity)}`;
      eye.setAttribute("aria-label", text);
      eye.title = text;
    }
  }

  update(): void {
    const wait = this.last + EVERY - performance.now();
    if (wait <= 0) this.write();
    else this.timer ??= setTimeout(() => this.write(), wait);
  }

  private write(): void {
    clearTimeout(this.timer);
    this.timer = undefined;
    this.last = performance.now();
    if (!this.node.open) return;
    this.setText(this.caption, `${this.display.of === "world" ? "In the world" : "As seen from the camera"}, at this frame`);
    for (const row of this.rows) {
      this.writePose(row);
      this.writeRest(row);
    }
  }

  private writeRest({ entity, cells }: Row): void {
    const { frame } = this.state;
    if (entity < 0) return this.setText(cells[Cell.hypotheses], this.trace.cameraHypotheses.length > 0 ? this.living(-1) : "");
    const object = this.trace.objects[entity];
    this.setText(cells[Cell.status], object.status ? (this.trace.statuses[object.status[frame]] ?? "") : "");
    this.setText(cells[Cell.hypotheses], this.living(entity));
    this.setText(cells[Cell.mode], percent(object.modeProbability?.(frame), 1));
    if (!this.trace.hasTracks) return;
    this.setText(cells[Cell.exists], percent(object.existence?.(frame), 1));
    const again = object.registerAgain?.[frame] ? ", register again" : "";
    this.setText(cells[Cell.track], (this.trace.healthAt(entity, frame) || "–") + again);
  }

  /** The weights of the hypotheses in this frame, the heaviest first. */
  private living(index: number): string {
    const { frame } = this.state;
    const slots = index < 0 ? this.trace.cameraHypotheses : this.trace.objects[index].hypotheses;
    const weights = slots.filter((slot) => slot.pose.has(frame)).map((slot) => slot.probability(frame));
    const shown = weights.sort((a, b) => b - a).slice(0, 3).map((weight) => fixed(100 * weight, weight < 0.01 ? 2 : 0));
    return weights.length === 0 ? "–" : `${weights.length}: ${shown.join(", ")}${weights.length > 3 ? ", …" : ""} %`;
  }

  private writePose({ entity, cells, sigmas }: Row): void {
    const { reading } = this;
    const isThere = reading.read(this.display.estimate(this.trace, entity), this.state.frame);
    for (let i = 0; i < 3; ++i) {
      this.setText(cells[i].firstElementChild!, isThere ? fixed(reading.p[i], 4) : "–");
      this.setText(sigmas[i], isThere && !Number.isNaN(reading.place[i]) ? `± ${short(reading.place[i])}` : "");
    }
    this.setText(cells[Cell.rotation].firstElementChild!, isThere ? rotationText(reading.q, this.display.form) : "–");
    this.setText(sigmas[Cell.rotation], isThere ? sigmaText(reading.turn) : "");
  }

  private setText(node: Element, text: string): void {
    if (node.textContent !== text) node.textContent = text;
  }
}
