// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { defineConfig } from "@playwright/test";
import tests from "../playwright.config.ts";

/** The browser of the tests, with one page at a time. */
export default defineConfig({ ...tests, testDir: ".", testMatch: "*.bench.ts", outputDir: "../test-results/bench", workers: 1 });
