// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What there is to say of one object, or the camera, at the shown frame and over the run.
import { type PoseDisplay, PoseReading, rotationText, sigmaText } from "../state/pose_display.ts";
import type { RunFacts, WorstMoment } from "../state/run_facts.ts";
import { CAMERA, type Entity, type RunState } from "../state/run_state.ts";
import { describe } from "../trace/events.ts";
import { hypothesesInWords } from "../trace/hypotheses.ts";
import type { Level } from "../trace/verdict.ts";
import { button, element } from "../ui/dom.ts";
import { momentLink } from "../ui/links.ts";
import { fixed, percent, plural, short } from "../ui/numbers.ts";
import { colourOf } from "../ui/palette.ts";
import { sparkline, type Sparkline, type SparkSeries } from "../ui/sparkline.ts";
import { MODE_PROBABILITY } from "./words.ts";

export const SIGNS: Readonly<Record<Level, string>> = { good: "✓", fair: "!", bad: "✗", none: "?" };

/** What is written of the worst moment. */
export function worstInWords({ of, size }: WorstMoment): string {
  if (of === "error") return `error of ${short(size)} sigma`;
  if (of === "mode") return `mode probability of ${percent(size)}`;
  return `3 sigma of ${short(3 * size)} mm`;
}

export class ObjectCard {
  readonly node: HTMLElement;
  private readonly reading = new PoseReading();
  private readonly place = element("dd", { class: "numbers" });
  private readonly turn = element("dd", { class: "numbers" });
  private readonly belief = element("span");
  private readonly bar = element("span", { class: "fill" });
  private readonly hypotheses = element("ul", { class: "hypotheses" });
  private readonly track = element("dd");
  private readonly spark: Sparkline | undefined;
  private said = "";

  constructor(
    private readonly state: RunState,
    private readonly facts: RunFacts,
    private readonly display: PoseDisplay,
    readonly entity: Entity,
  ) {
    const name = state.nameOf(entity);
    const { word, reason, sentence, level } = facts.verdict(entity);
    const verdict = element("span", { class: `verdict ${level}`, title: sentence }, element("span", { "aria-hidden": "true" }, SIGNS[level]), ` ${word}`);
    const series = this.series();
    this.spark = series && sparkline(state, series, entity < 0 ? "var(--ink)" : colourOf(entity));
    const head = button(name, () => state.select(entity), { class: "name" });
    if (entity >= 0) head.style.setProperty("--swatch", colourOf(entity));
    this.node = element("article", { class: "card", "data-entity": name },
      element("h2", {}, head, verdict), this.factList(), element("p", { class: "hint reason", title: sentence }, reason), ...(this.spark ? [this.spark.node] : []));
    this.node.addEventListener("click", (event) => {
      if (!(event.target as HTMLElement).closest("button, .spark")) state.select(entity);
    });
    this.markSelected();
    this.update();
  }

  private get object() {
    return this.entity < 0 ? undefined : this.state.trace.objects[this.entity];
  }

  private factList(): HTMLElement {
    const list = element("dl");
    const add = (name: string, value: HTMLElement, title = "") => list.append(element("dt", title ? { title } : {}, name), value);
    const { object } = this;
    add("Position", this.place);
    add("Rotation", this.turn);
    if (object?.modeProbability) {
      add("Mode probability", element("dd", {}, element("span", { class: "meter", "aria-hidden": "true" }, this.bar), this.belief), MODE_PROBABILITY);
    }
    if (object ? object.hypotheses.length > 0 : this.state.trace.cameraHypotheses.length > 0) add("Hypotheses", element("dd", {}, this.hypotheses));
    if (object?.existence || object?.health) add("Track", this.track);
    if (object) add("Flips", element("dd", {}, ...this.flips()));
    const worst = this.facts.worst(this.entity);
    if (worst) add("Worst", element("dd", {}, momentLink(this.state, worst.frame, this.entity), ` ${worstInWords(worst)}`));
    return list;
  }

  private flips(): (Node | string)[] {
    const flips = this.facts.eventsOfEntity(this.entity).filter(({ kind }) => kind === "flipped");
    const count = flips.reduce((sum, flip) => sum + flip.count, 0);
    if (count === 0) return ["none"];
    const last = flips[flips.length - 1];
    return [`${plural(count, "flip or jump", "flips or jumps")}, the last at `, momentLink(this.state, last.peak, this.entity), `: ${describe(this.state.trace, last).replace(/^the estimate /, "")}`];
  }

  /** Errors where they are known; else how sure the filter is. */
  private series(): SparkSeries | undefined {
    const deviation = this.facts.deviation(this.entity);
    if (deviation) return { label: "largest error in sigmas; dotted: 3", at: (frame) => deviation.largest[frame], top: 6, limit: 3 };
    const mode = this.object?.modeProbability;
    if (mode) return { label: "mode probability, 0 to 1", at: (frame) => mode(frame) ?? NaN, top: 1 };
    const estimate = this.facts.judged(this.entity);
    if (!estimate?.hasPositionSd) return undefined;
    const sd = [0, 0, 0];
    const at = (frame: number) => {
      if (!estimate.pose.has(frame)) return NaN;
      estimate.positionSdAt(frame, sd);
      return 3000 * Math.max(sd[0], sd[1], sd[2]);
    };
    const top = 3 * (this.facts.worst(this.entity)?.size ?? 1);
    return { label: `3 sigma of the position, 0 to ${short(top)} mm`, at, top };
  }

  markSelected(): void {
    if (this.state.selected === this.entity) this.node.setAttribute("aria-current", "true");
    else this.node.removeAttribute("aria-current");
  }

  update(): void {
    const { state, reading, object } = this;
    const { frame } = state;
    this.spark?.mark();
    // The camera has no pose as seen from itself; its card stays that of the world.
    const estimate = this.entity === CAMERA ? state.trace.camera : this.display.estimate(state.trace, this.entity);
    if (reading.read(estimate, frame)) {
      setLines(this.place, `${reading.p.map((value) => fixed(value, 3)).join(", ")} m`, sigmaText(reading.place, "mm"));
      setLines(this.turn, `${rotationText(reading.q, this.display.form)}${this.display.form === "quaternion" ? "" : " deg"}`, sigmaText(reading.turn, "deg"));
    } else for (const node of [this.place, this.turn]) setLines(node, "–", "");
    if (object?.modeProbability) {
      const mode = object.modeProbability(frame);
      this.bar.style.width = `${fixed(100 * (mode ?? 0), 1)}%`;
      setText(this.belief, `${percent(mode, 1)} by the filter's own belief`);
    }
    this.writeHypotheses();
    if (object) setText(this.track, this.trackText());
  }

  private writeHypotheses(): void {
    const { trace, frame } = this.state;
    const words = hypothesesInWords(this.object?.hypotheses ?? trace.cameraHypotheses, frame) ?? ["none"];
    const text = words.join("\n");
    if (text === this.said) return;
    this.said = text;
    this.hypotheses.replaceChildren(...words.map((word) => element("li", {}, word)));
  }

  private trackText(): string {
    const { trace, frame } = this.state;
    const object = this.object!;
    const existence = object.existence?.(frame);
    const parts = [
      ...(existence === undefined ? [] : [`exists with ${percent(existence, 1)}`]),
      ...(object.health ? [trace.healthAt(this.entity, frame)] : []),
      ...(object.registerAgain?.[frame] ? ["should be registered again"] : []),
    ];
    return parts.join(", ") || "–";
  }
}

function setText(node: Element, text: string): void {
  if (node.textContent !== text) node.textContent = text;
}

/** A value and, after it, what it is sure to. */
function setLines(node: HTMLElement, value: string, sigma: string): void {
  if (node.childElementCount === 0) node.append(element("span"), element("small", { title: "three standard deviations about x, y, z" }));
  setText(node.firstElementChild!, value);
  setText(node.lastElementChild!, sigma);
}
