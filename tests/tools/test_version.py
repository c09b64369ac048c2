# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Tests of tools/version.py, and of what it says about this checkout."""

import subprocess
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import version  # noqa: E402

CMAKE = "cmake_minimum_required(VERSION 3.25)\nproject(posemix VERSION 1.2.3 LANGUAGES CXX)\n"
CITATION = "cff-version: 1.2.0\nversion: 1.2.3\nlicense: MIT\n"
CHANGELOG = "# Changelog\n\n## Unreleased (1.3.0)\n\n- new\n\n## 1.2.3 (2020-01-02)\n\n- old\n"


class Version(unittest.TestCase):
    def errors(self, cmake=CMAKE, citation=CITATION, changelog=CHANGELOG, release=False):
        return version.contradictions(cmake, citation, changelog, release)[1]

    def test_agreement(self):
        self.assertEqual(version.contradictions(CMAKE, CITATION, CHANGELOG, False), ("1.2.3", []))

    def test_contradictions(self):
        self.assertIn("got version 1.2.2, expected 1.2.3", self.errors(citation=CITATION.replace("1.2.3", "1.2.2"))[0])
        self.assertIn("expected a version after 1.2.3", self.errors(changelog=CHANGELOG.replace("1.3.0", "1.2.3"))[0])
        self.assertIn("got first section", self.errors(changelog=CHANGELOG.replace("Unreleased (1.3.0)", "Next"))[0])
        self.assertIn("unreleased", self.errors(release=True)[0])
        released = CHANGELOG.replace("Unreleased (1.3.0)", "1.3.0 (2021-02-03)")
        self.assertIn("got first section 1.3.0, expected 1.2.3", self.errors(changelog=released)[0])

    def test_setting_it_is_one_step(self):
        texts = version.changed(CMAKE, CITATION, CHANGELOG, "1.3.0", "2021-02-03")
        self.assertEqual(version.contradictions(*texts, release=True), ("1.3.0", []))
        self.assertIn("## 1.2.3 (2020-01-02)", texts[2])
        self.assertIn("cff-version: 1.2.0", texts[1])
        again = version.changed(*texts, "1.3.0", "2021-02-03")
        self.assertEqual(again, texts)
        undated = texts[1].replace("2021-02-03", "2021-02-04")
        self.assertIn("date-released", self.errors(texts[0], undated, texts[2], release=True)[0])

    def test_this_checkout(self):
        result = subprocess.run([ROOT / "tools" / "version.py"], capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stdout)


if __name__ == "__main__":
    unittest.main()
