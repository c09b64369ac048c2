// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The part of the time that plots show: one for all plots of a page, so that the moment one zoomed to is the same in all tabs.

export type Range = [number, number];

export class TimeWindow {
  private shown: Range | undefined;
  private readonly listeners = new Set<() => void>();

  /** Undefined: the whole time. */
  get range(): Range | undefined {
    return this.shown;
  }

  set(range: Range | undefined): void {
    const same = range === this.shown || (range && this.shown && range[0] === this.shown[0] && range[1] === this.shown[1]);
    if (same || (range && !(range[1] > range[0]))) return;
    this.shown = range;
    for (const listener of this.listeners) listener();
  }

  onChange(listener: () => void): void {
    this.listeners.add(listener);
  }

  /** Shows a part of the time, narrower for a factor below one, about a moment; the whole where there is no more. */
  zoom(factor: number, about: number, whole: Range): void {
    const [low, high] = this.shown ?? whole;
    const width = (high - low) * factor;
    if (width >= whole[1] - whole[0]) return this.set(undefined);
    const centre = about >= low && about <= high ? about : 0.5 * (low + high);
    const share = (centre - low) / (high - low);
    const start = Math.max(whole[0], Math.min(whole[1] - width, centre - share * width));
    this.set([start, start + width]);
  }
}

export const timeWindow = new TimeWindow();
