// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Parts that all kinds of page share.
import type { Payload } from "../payload.ts";
import { element } from "../ui/dom.ts";
import { themeButton } from "../ui/theme.ts";

/** The interface of the page for tests. */
export interface Probe {
  readonly kind: string;
  readonly [key: string]: unknown;
}

declare global {
  interface Window {
    posemix?: Probe;
  }
}

export function publish(probe: Probe): void {
  window.posemix = Object.freeze(probe);
}

export function header(payload: Payload, subtitle: string): HTMLElement {
  return element(
    "header",
    { class: "top" },
    element("div", {}, element("h1", {}, payload.title), element("p", { class: "subtitle" }, subtitle)),
    themeButton(),
  );
}

export function footer(payload: Payload): HTMLElement {
  return element("footer", {}, payload.program);
}

/** A picture of the results folder; it is shown as an image, so that scripts in it do not run. */
export function picture(name: string, svg: string): HTMLElement {
  const source = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`;
  return element("figure", { class: "picture" }, element("img", { src: source, alt: name, loading: "lazy" }), element("figcaption", {}, name));
}

/** The notice in place of a scene, in a browser without WebGL. */
export function noScene(error: unknown): HTMLElement {
  return element("p", { class: "notice" }, `The scene cannot be drawn: ${error instanceof Error ? error.message : String(error)}`);
}
