// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Parts that all kinds of page share.
import type { Payload } from "../payload.ts";
import { button, element } from "../ui/dom.ts";
import type { Keys } from "../ui/keys.ts";
import { altOf } from "../ui/alt.ts";
import { themeButton } from "../ui/theme.ts";
import { provenanceNode } from "./provenance.ts";

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

/** Title, provenance and buttons; with `keys` one of them lists these. */
export function header(payload: Payload, subtitle: string, keys?: Keys): HTMLElement {
  const provenance = provenanceNode(payload.documents);
  const lines = subtitle !== "" && subtitle !== payload.title ? [element("p", { class: "subtitle" }, subtitle)] : [];
  return element(
    "header",
    { class: "top" },
    element("div", {}, element("h1", {}, payload.title), ...lines, ...(provenance ? [provenance] : [])),
    element("div", { class: "buttons" }, ...(keys ? [button("Keys", () => keys.help(), { title: "Keys (?)" })] : []), themeButton()),
  );
}

export function footer(payload: Payload): HTMLElement {
  return element("footer", {}, payload.program);
}

/** A picture of the results folder; it is shown as an image, so that scripts in it do not run. */
export function picture(name: string, svg: string): HTMLElement {
  const source = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`;
  return element("figure", { class: "picture" }, element("img", { src: source, alt: altOf(name, svg), loading: "lazy" }), element("figcaption", {}, name));
}

/** The notice in place of a scene, in a browser without WebGL, and what to do then. */
export function noScene(error: unknown): HTMLElement {
  const reason = error instanceof Error ? error.message : String(error);
  return element("div", { class: "notice no-scene" },
    element("p", {}, "The scene in 3-D needs WebGL, which this browser does not offer at the moment. All numbers and plots are shown without it."),
    element("p", {}, "To see the scene: turn on hardware acceleration in the settings of the browser and open the page again, or open it in another browser (Firefox, Chrome, Edge, Safari); over a remote desktop, open it on your own machine."),
    element("p", { class: "hint" }, `The browser says: ${reason}`));
}
