// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import type { OneOf, Setting } from "../state/setting.ts";
import { choice } from "./dom.ts";

/** A list that shows and changes a setting. */
export function settingChoice<T extends string>(text: string, options: readonly (readonly [T, string])[], setting: Setting<T>): HTMLLabelElement {
  const made = choice(text, options, setting.value, (value) => setting.set(value as T));
  setting.onChange(() => (made.querySelector("select")!.value = setting.value));
  return made;
}

/** The same for a setting that knows its values. */
export const oneOfChoice = <T extends string>(text: string, setting: OneOf<T>): HTMLLabelElement => settingChoice(text, setting.options, setting);
