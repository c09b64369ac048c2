// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { BadPayload, readPayload } from "./payload.ts";
import { element } from "./ui/dom.ts";

function failure(error: unknown): HTMLElement {
  const message = error instanceof BadPayload ? error.message : `The page failed: ${String(error)}`;
  return element("main", { class: "notice", role: "alert" }, element("h1", {}, "This report cannot be shown"), element("p", {}, message));
}

async function start(): Promise<void> {
  const app = document.getElementById("app")!;
  try {
    const payload = readPayload(document.getElementById("posemix-report")?.textContent ?? "");
    document.title = payload.title;
    app.replaceChildren(element("main", {}, element("h1", {}, payload.title)));
  } catch (error) {
    app.replaceChildren(failure(error));
  }
}

void start();
