// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A page of a results folder, without the program: node tests/make_page.mjs FOLDER OUT.html
import { readFile, rm, writeFile } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { bundle } from "./bundle.mjs";

const here = path.dirname(fileURLToPath(import.meta.url));
const { outdir, files } = await bundle([path.join(here, "folder.ts")]);
const { fill, payloadOfFolder } = await import(pathToFileURL(files[0]).href);
const template = await readFile(path.join(here, "..", "dist", "report.html"), "utf8");
const [folder, target] = process.argv.slice(2);
await writeFile(target, fill(template, payloadOfFolder(folder)));
await rm(outdir, { recursive: true });
