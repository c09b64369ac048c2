// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { button, choice, element } from "./dom.ts";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 30, 100];
const LARGE_STEP = 0.02;

export interface Clock {
  frames: number;
  seconds: Float64Array;
  frameAt(seconds: number): number;
}

/** Controls for the shown frame: a bar to scrub and play, and keys. */
export class Player {
  readonly node: HTMLElement;
  frame = 0;
  private playing = false;
  private speed = 1;
  private time = 0;
  private last = 0;
  private readonly bar: HTMLInputElement;
  private readonly button: HTMLButtonElement;
  private readonly text = element("output", { class: "time" });

  constructor(private readonly clock: Clock, private readonly show: (frame: number) => void) {
    const length = clock.seconds[clock.frames - 1];
    this.speed = SPEEDS.find((speed) => length / speed < 120) ?? SPEEDS[SPEEDS.length - 1];
    if (length < 120) this.speed = 1;
    this.button = button("▶", () => this.toggle(), { class: "play" });
    this.bar = element("input", { type: "range", min: 0, max: clock.frames - 1, step: 1, value: 0, "aria-label": "Frame" });
    this.bar.addEventListener("input", () => this.go(Number(this.bar.value)));
    const speeds = choice("Speed", SPEEDS.map((speed) => [String(speed), `${speed}×`] as const), String(this.speed), (value) => (this.speed = Number(value)));
    this.node = element("div", { class: "player", role: "group", "aria-label": "Timeline" }, this.button, this.bar, this.text, speeds);
    document.addEventListener("keydown", (event) => this.key(event));
    this.describe();
  }

  /** Shows a frame. */
  go(frame: number): void {
    const next = Math.max(0, Math.min(this.clock.frames - 1, Math.round(frame)));
    this.time = this.clock.seconds[next];
    if (next === this.frame) return;
    this.frame = next;
    this.bar.value = String(next);
    this.describe();
    this.show(next);
  }

  seek(seconds: number): void {
    this.go(this.clock.frameAt(seconds));
  }

  toggle(): void {
    this.playing = !this.playing;
    if (this.playing && this.frame === this.clock.frames - 1) this.go(0);
    this.describe();
    this.last = performance.now();
    if (this.playing) requestAnimationFrame((now) => this.step(now));
  }

  private step(now: number): void {
    if (!this.playing) return;
    const time = this.time + (this.speed * Math.max(0, now - this.last)) / 1000;
    this.last = now;
    this.go(this.clock.frameAt(time));
    this.time = time;
    if (this.frame === this.clock.frames - 1) {
      this.playing = false;
      this.describe();
    } else requestAnimationFrame((next) => this.step(next));
  }

  private describe(): void {
    const { frames, seconds } = this.clock;
    this.text.textContent = `${seconds[this.frame].toFixed(2)} s · frame ${this.frame} / ${frames - 1}`;
    this.bar.setAttribute("aria-valuetext", `frame ${this.frame} of ${frames - 1}, ${seconds[this.frame].toFixed(2)} seconds`);
    this.button.textContent = this.playing ? "❚❚" : "▶";
    this.button.setAttribute("aria-label", this.playing ? "Pause" : "Play");
  }

  private key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    const own = target === this.bar;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (!own && target.closest("input, select, textarea, [role=tab], .scroll")) return;
    if (event.key === " ") {
      if (target.closest("button, summary, a")) return;
      this.toggle();
    } else {
      const large = Math.max(10, Math.round(LARGE_STEP * this.clock.frames));
      const step = event.shiftKey ? large : 1;
      const goals: Record<string, number> = {
        ArrowRight: this.frame + step, ArrowLeft: this.frame - step, Home: 0, End: this.clock.frames - 1,
        PageUp: this.frame - large, PageDown: this.frame + large,
      };
      const goal = goals[event.key];
      if (goal === undefined || ((event.key === "PageUp" || event.key === "PageDown") && !own)) return;
      this.go(goal);
    }
    event.preventDefault();
  }
}
