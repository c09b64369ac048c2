// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Bundles the page into one file: node build.mjs [--outdir DIR]
import { createHash } from "node:crypto";
import { mkdir, readFile, rename, writeFile } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { build } from "esbuild";

const MARK = "@POSEMIX_REPORT@";
const here = path.dirname(fileURLToPath(import.meta.url));
const { values } = parseArgs({ options: { outdir: { type: "string" } } });
const outdir = path.resolve(values.outdir ?? process.env.POSEMIX_REPORT_OUT ?? path.join(here, "dist"));

async function bundle(entry) {
  const result = await build({
    entryPoints: [path.join(here, "src", entry)],
    bundle: true,
    write: false,
    minify: true,
    format: "iife",
    target: ["es2022"],
    legalComments: "none",
    logLevel: "warning",
  });
  return result.outputFiles[0].text.trimEnd();
}

/** The licences of what is bundled, as a comment of the page. */
async function notices() {
  const texts = [];
  for (const name of ["three", "uplot"]) {
    const folder = path.join(here, "node_modules", name);
    const { version } = JSON.parse(await readFile(path.join(folder, "package.json"), "utf8"));
    const licence = (await readFile(path.join(folder, "LICENSE"), "utf8")).trim();
    texts.push(`${name} ${version}\n${licence}`);
  }
  return texts.join("\n\n").replaceAll("--", "- -");
}

/** What the page's policy allows: this script or style, and none that somebody brings in by a name or a text. */
function hashOf(text) {
  return `'sha256-${createHash("sha256").update(text).digest("base64")}'`;
}

const [html, bundled, style, licences] = await Promise.all([
  readFile(path.join(here, "src", "index.html"), "utf8"),
  bundle("main.ts"),
  bundle("style.css"),
  notices(),
]);
const script = bundled.replaceAll("</script", "<\\/script");
const page = html
  .replace("@SCRIPT_HASH@", () => hashOf(script))
  .replace("@STYLE_HASH@", () => hashOf(style))
  .replace("@LICENCES@", () => licences)
  .replace("@STYLE@", () => style)
  .replace("@SCRIPT@", () => script);
if (page.split(MARK).length !== 2) throw new Error(`the page must contain ${MARK} exactly once`);

await mkdir(outdir, { recursive: true });
const target = path.join(outdir, "report.html");
await writeFile(`${target}.part`, page);
await rename(`${target}.part`, target);
console.log(`${target}: ${(Buffer.byteLength(page) / 1024).toFixed(0)} KiB`);
