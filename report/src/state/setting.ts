// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

/** A value that several parts of the page show and change. */
export class Setting<T> {
  private readonly listeners = new Set<() => void>();

  constructor(private now: T) {}

  get value(): T {
    return this.now;
  }

  set(value: T): void {
    if (value === this.now) return;
    this.now = value;
    for (const listener of this.listeners) listener();
  }

  onChange(listener: () => void): void {
    this.listeners.add(listener);
  }
}

/** One of few values, with what they are called; an address may name it. */
export class OneOf<T extends string> extends Setting<T> {
  constructor(readonly options: readonly (readonly [T, string])[], readonly first: T) {
    super(first);
  }

  /** Takes a value as an address has it; what is none is the first. */
  take(text: string | null): void {
    this.set(this.options.find(([value]) => value === text)?.[0] ?? this.first);
  }
}
