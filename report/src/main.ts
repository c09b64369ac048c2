// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { comparisonPage } from "./pages/comparison.ts";
import { consistencyPage } from "./pages/consistency.ts";
import { mixturePage } from "./pages/mixture.ts";
import { saltBoxPage } from "./pages/salt_box.ts";
import { slamPage } from "./pages/slam.ts";
import { studyPage } from "./pages/study.ts";
import { BadPayload, type Payload, readPayload } from "./payload.ts";
import { element } from "./ui/dom.ts";

async function pageOf(payload: Payload): Promise<HTMLElement> {
  switch (payload.kind) {
    case "slam":
      return slamPage(payload);
    case "mixture":
      return mixturePage(payload);
    case "salt_box":
      return saltBoxPage(payload);
    case "study":
      return studyPage(payload);
    case "consistency":
      return consistencyPage(payload);
    case "comparison":
      return comparisonPage(payload);
  }
}

function failure(error: unknown): HTMLElement {
  const message = error instanceof BadPayload ? error.message : `The page failed: ${String(error)}`;
  return element("main", {}, element("div", { class: "notice", role: "alert" },
    element("h1", {}, "This report cannot be shown"), element("p", {}, message)));
}

async function start(): Promise<void> {
  const app = document.getElementById("app")!;
  try {
    const source = document.getElementById("posemix-report");
    const payload = readPayload(source?.textContent ?? "");
    source?.remove();
    document.title = payload.title;
    app.replaceChildren(await pageOf(payload));
  } catch (error) {
    app.replaceChildren(failure(error));
  }
  document.documentElement.dataset["ready"] = "true";
}

void start();
