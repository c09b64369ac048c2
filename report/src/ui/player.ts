// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import type { RunState } from "../state/run_state.ts";
import { button, choice, element } from "./dom.ts";
import type { Keys } from "./keys.ts";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 30, 100];
const LARGE_STEP = 0.02;
/** A run that takes longer at its own speed [s] is played faster. */
const LONG = 120;

/** Controls for the shown frame: a bar to scrub and play, and keys. */
export class Player {
  readonly node: HTMLElement;
  /** Above the bar and as wide: marks of what happens. */
  readonly strips = element("div", { class: "strips" });
  private playing = false;
  private speed = 1;
  private time = 0;
  private last = 0;
  private readonly bar: HTMLInputElement;
  private readonly button: HTMLButtonElement;
  private readonly text = element("output", { class: "time" });

  constructor(private readonly state: RunState, keys: Keys) {
    const { frames, seconds } = state.trace;
    const length = seconds[frames - 1];
    if (length >= LONG) this.speed = SPEEDS.find((speed) => length / speed < LONG) ?? SPEEDS[SPEEDS.length - 1];
    this.button = button("▶", () => this.toggle(), { class: "play" });
    this.bar = element("input", { type: "range", min: 0, max: frames - 1, step: 1, value: 0, "aria-label": "Frame" });
    this.bar.addEventListener("input", () => state.go(Number(this.bar.value)));
    const speeds = choice("Speed", SPEEDS.map((speed) => [String(speed), `${speed}×`] as const), String(this.speed), (value) => (this.speed = Number(value)));
    const track = element("div", { class: "track" }, this.strips, this.bar);
    this.node = element("div", { class: "player", role: "group", "aria-label": "Timeline" }, this.button, track, this.text, speeds);
    state.on("frame", () => this.describe());
    this.addKeys(keys);
    this.describe();
  }

  toggle(): void {
    const { state } = this;
    this.playing = !this.playing;
    if (this.playing && state.frame === state.trace.frames - 1) state.go(0);
    this.time = state.seconds;
    this.describe();
    this.last = performance.now();
    if (this.playing) requestAnimationFrame((now) => this.step(now));
  }

  private step(now: number): void {
    if (!this.playing) return;
    const { state } = this;
    // The reader may have moved to another frame.
    const shown = state.trace.frameAt(this.time) === state.frame ? this.time : state.seconds;
    this.time = shown + (this.speed * Math.max(0, now - this.last)) / 1000;
    this.last = now;
    state.seek(this.time);
    if (state.frame === state.trace.frames - 1) {
      this.playing = false;
      this.describe();
    } else requestAnimationFrame((next) => this.step(next));
  }

  private describe(): void {
    const { frame, seconds, trace } = this.state;
    this.bar.value = String(frame);
    this.text.textContent = `${seconds.toFixed(2)} s · frame ${frame} / ${trace.frames - 1}`;
    this.bar.setAttribute("aria-valuetext", `frame ${frame} of ${trace.frames - 1}, ${seconds.toFixed(2)} seconds`);
    this.button.textContent = this.playing ? "❚❚" : "▶";
    this.button.setAttribute("aria-label", this.playing ? "Pause" : "Play");
  }

  private addKeys(keys: Keys): void {
    const { state } = this;
    const large = Math.max(10, Math.round(LARGE_STEP * state.trace.frames));
    const move = (step: number) => () => state.go(state.frame + step);
    keys.add([" ", "k"], "play, pause", () => this.toggle());
    keys.add(["ArrowLeft", ","], "the frame before", move(-1));
    keys.add(["ArrowRight", "."], "the next frame", move(1));
    keys.add(["Shift+ArrowLeft", "j"], `${large} frames back`, move(-large));
    keys.add(["Shift+ArrowRight", "l"], `${large} frames on`, move(large));
    keys.add(["Home"], "the first frame", () => state.go(0));
    keys.add(["End"], "the last frame", () => state.go(state.trace.frames - 1));
  }
}
