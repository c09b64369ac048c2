# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Tests of tools/tidy_units.py."""

import json
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
import tidy_units  # noqa: E402

FILES = {
    "include/posemix/lie/so3.hpp": "",
    "include/posemix/lie/se3.hpp": '#include "posemix/lie/so3.hpp"\n',
    "include/posemix/lie/unused.hpp": "",
    "src/lie/own.hpp": "#include <vector>\n",
    "src/lie/a.cpp": '#include "own.hpp"\n#include "posemix/lie/se3.hpp"\n',
    "src/lie/b.cpp": '#include "posemix/lie/so3.hpp"\n',
    "src/io/c.cpp": '#  include "lie/own.hpp"\n',
    "build/unity_0.cxx": '// NOLINTNEXTLINE\n#include "{root}/src/lie/a.cpp"\n#include "{root}/src/lie/b.cpp"\n',
    "build/unity_1.cxx": '#include "{root}/src/io/c.cpp"\n',
}


class Units(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name).resolve()
        for name, text in FILES.items():
            path = self.root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text.format(root=self.root))
        self.units = [self.root / "build" / f"unity_{i}.cxx" for i in range(2)]

    def chosen(self, *names):
        folders = [self.root / "include", self.root / "src"]
        found = tidy_units.units_for({self.root / name for name in names}, self.units, folders)
        return [unit.name for unit in found]

    def test_compile_commands_name_the_units_once(self):
        entries = [{"directory": str(self.root), "file": name} for name in ("b.cpp", "a.cpp", "b.cpp")]
        (self.root / "build" / "compile_commands.json").write_text(json.dumps(entries))
        found = tidy_units.compiled_files(self.root / "build")
        self.assertEqual(found, [self.root / "a.cpp", self.root / "b.cpp"])

    def test_a_changed_source_needs_the_unit_that_has_it(self):
        self.assertEqual(self.chosen("src/lie/b.cpp"), ["unity_0.cxx"])
        self.assertEqual(self.chosen("src/io/c.cpp", "src/lie/a.cpp"), ["unity_0.cxx", "unity_1.cxx"])
        self.assertEqual(self.chosen(), [])

    def test_a_changed_header_is_seen_once(self):
        self.assertEqual(self.chosen("src/lie/own.hpp"), ["unity_0.cxx"])
        self.assertEqual(self.chosen("src/lie/own.hpp", "src/io/c.cpp"), ["unity_1.cxx"])
        self.assertEqual(self.chosen("include/posemix/lie/so3.hpp"), ["unity_0.cxx"])

    def test_a_header_that_no_source_includes_needs_no_unit(self):
        self.assertEqual(self.chosen("include/posemix/lie/unused.hpp"), [])


if __name__ == "__main__":
    unittest.main()
