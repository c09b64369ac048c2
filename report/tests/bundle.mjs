// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Bundles scripts of the tests, so that node can run them: bundle(entries) returns their paths.
import { mkdtemp } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = path.dirname(fileURLToPath(import.meta.url));

export async function bundle(entries) {
  const outdir = await mkdtemp(path.join(here, "..", "node_modules", ".posemix-"));
  await build({
    entryPoints: entries, bundle: true, outdir, platform: "node", format: "esm", target: "node18",
    packages: "external", outExtension: { ".js": ".mjs" }, entryNames: "[name]", logLevel: "warning",
  });
  return { outdir, files: entries.map((entry) => path.join(outdir, `${path.basename(entry, ".ts")}.mjs`)) };
}
