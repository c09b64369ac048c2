// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// How the scene draws uncertainty, as its controls and the address name it.
import type { UncertaintyLook } from "../scene/layers.ts";
import { OneOf } from "./setting.ts";

export class SceneLook {
  readonly sigma = new OneOf([["1", "1 sigma"], ["2", "2 sigma"], ["3", "3 sigma"], ["all", "1, 2, 3 sigma"]], "3");
  readonly factor = new OneOf([["visible", "so that it is visible"], ["1", "in true size"], ["10", "10 times larger"], ["100", "100 times larger"]], "visible");
  readonly frame = new OneOf([["world", "in the world"], ["camera", "relative to the camera"], ["object", "along the object's axes"]], "world");

  get value(): UncertaintyLook {
    const [sigma, factor] = [this.sigma.value, this.factor.value];
    return {
      sigma: sigma === "all" ? 0 : (Number(sigma) as 1 | 2 | 3),
      factor: factor === "visible" ? 0 : (Number(factor) as 1 | 10 | 100),
      frame: this.frame.value,
    };
  }

  onChange(listener: () => void): void {
    for (const one of [this.sigma, this.factor, this.frame]) one.onChange(listener);
  }
}
