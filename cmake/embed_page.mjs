// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Writes a C++ source with a page, compressed: node embed_page.mjs PAGE.html SOURCE.cpp
import { readFileSync, writeFileSync } from "node:fs";
import { deflateSync } from "node:zlib";

const [pagePath, sourcePath] = process.argv.slice(2);
const page = readFileSync(pagePath);
const stream = deflateSync(page, { level: 9 });
const BYTES_PER_LINE = 32;

/** A byte inside a string literal; octal escapes end after three digits. */
function escaped(byte) {
  return `\\${byte.toString(8).padStart(3, "0")}`;
}

const lines = [];
for (let at = 0; at < stream.length; at += BYTES_PER_LINE) {
  lines.push(`    "${Array.from(stream.subarray(at, at + BYTES_PER_LINE), escaped).join("")}"`);
}
writeFileSync(
  sourcePath,
  `#include "report_page.hpp"

namespace posemix::internal {
namespace {

constexpr char kReportStream[] =
${lines.join("\n")};

}  // namespace

ReportPage report_page() { return {{kReportStream, sizeof kReportStream - 1}, ${page.length}}; }

}  // namespace posemix::internal
`,
);
