// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What a figure shows, in words, from the words that stand in it.

const MOST_WORDS = 12;

/** The title of a drawing and the words of its axes and keys. The text is parsed, and not put into the page: nothing in it runs. */
export function altOf(name: string, drawing: string): string {
  const document = new DOMParser().parseFromString(drawing, "image/svg+xml");
  if (document.querySelector("parsererror")) return name;
  const given = document.querySelector("svg > title, svg > desc")?.textContent?.trim();
  const words: string[] = [];
  for (const node of document.querySelectorAll("text")) {
    const text = node.textContent?.trim().replaceAll(/\s+/g, " ") ?? "";
    // Numbers of axes say little without the picture.
    if (text !== "" && !/^[-−+]?[\d.,]+(e[-+]?\d+)?\s*%?$/.test(text) && !words.includes(text)) words.push(text);
  }
  const title = given || words.shift();
  const rest = words.slice(0, MOST_WORDS);
  if (title === undefined) return name;
  return `${name}: ${title}${rest.length > 0 ? `. With ${rest.join(", ")}${words.length > rest.length ? ", and more" : ""}.` : ""}`;
}
