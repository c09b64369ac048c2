# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Tests of tools/check_includes.py."""

import contextlib
import io
import re
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
import check_includes  # noqa: E402

HEAD = "// SPDX-License-Identifier: MIT\n// SPDX-FileCopyrightText: posemix contributors\n"


def messages(path, body, head=HEAD):
    return [message for _, message in check_includes.check_file(path, head + body)]


class Directions(unittest.TestCase):
    def test_every_pair_of_rooms(self):
        rooms = check_includes.ROOMS
        for i, room in enumerate(rooms):
            for j, included in enumerate(rooms):
                body = f'#include "posemix/{included}/x.hpp"\n'
                for path in (f"src/{room}/a.cpp", f"tests/{room}/test_a.cpp", f"bench/{room}/a.cpp"):
                    self.assertEqual(len(messages(path, body)), 1 if j > i else 0, (path, included))
                header = messages(f"include/posemix/{room}/a.hpp", "#pragma once\n" + body)
                self.assertEqual(len(header), 1 if j > i else 0, (room, included))

    def test_slam_must_not_include_io_but_io_may_include_slam(self):
        self.assertTrue(messages("src/slam/a.cpp", '#include "posemix/io/tum.hpp"\n'))
        self.assertFalse(messages("src/io/a.cpp", '#include "posemix/slam/sequence.hpp"\n'))

    def test_spacing_does_not_hide_an_include(self):
        self.assertTrue(messages("src/lie/a.cpp", '  #  include   "posemix/io/tum.hpp"  // why\n'))

    def test_violation_names_its_line(self):
        found = list(check_includes.check_file("src/lie/a.cpp", HEAD + '\n#include "posemix/io/a.hpp"\n'))
        self.assertEqual([number for number, _ in found], [4])

    def test_unknown_room_and_umbrella_are_violations_inside_a_room(self):
        self.assertTrue(messages("src/lie/a.cpp", '#include "posemix/cellar/a.hpp"\n'))
        self.assertTrue(messages("src/lie/a.cpp", '#include "posemix/posemix.hpp"\n'))

    def test_own_headers_need_quotes_and_no_parent_folders(self):
        self.assertTrue(messages("src/lie/a.cpp", "#include <posemix/lie/so3.hpp>\n"))
        self.assertFalse(messages("tests/packaging/consumer/main.cpp", "#include <posemix/lie/so3.hpp>\n"))
        self.assertTrue(messages("src/lie/a.cpp", '#include "../base/private.hpp"\n'))
        self.assertFalse(messages("src/lie/a.cpp", '#include "private.hpp"\n#include <Eigen/Core>\n'))

    def test_shared_helpers_of_tests_follow_the_same_order(self):
        self.assertFalse(messages("tests/slam/test_a.cpp", '#include "filter/scenario.hpp"\n'))
        self.assertTrue(messages("tests/filter/test_a.cpp", '#include "slam/scenario.hpp"\n'))

    def test_test_tools_are_for_tests(self):
        body = '#include "posemix/testing/data.hpp"\n'
        self.assertFalse(messages("tests/lie/test_a.cpp", body))
        self.assertFalse(messages("include/posemix/testing/a.hpp", "#pragma once\n" + body))
        self.assertTrue(messages("src/lie/a.cpp", body))
        self.assertTrue(messages("include/posemix/lie/a.hpp", "#pragma once\n" + body))

    def test_test_tools_may_include_rooms_but_not_the_program(self):
        path = "include/posemix/testing/a.hpp"
        self.assertFalse(messages(path, '#pragma once\n#include "posemix/io/a.hpp"\n'))
        self.assertTrue(messages(path, '#pragma once\n#include "posemix/app/a.hpp"\n'))


class Rooms(unittest.TestCase):
    def test_rooms_are_those_of_the_build(self):
        build = (Path(__file__).resolve().parents[2] / "CMakeLists.txt").read_text(encoding="utf-8")
        rooms = re.search(r"set\(POSEMIX_ROOMS ([^)]*)\)", build)[1].split()
        self.assertEqual((*rooms, "live", "study", "fetch", "app"), check_includes.ROOMS)


class Heads(unittest.TestCase):
    def test_header_without_pragma_once(self):
        self.assertTrue(messages("include/posemix/lie/a.hpp", "\n"))
        self.assertFalse(messages("src/lie/a.cpp", "\n"))

    def test_headers_for_every_set_of_vector_instructions(self):
        guard = "#if defined(A) == defined(HWY_TARGET_TOGGLE)\n"
        self.assertFalse(messages("src/mixture/a-inl.hpp", guard))
        self.assertTrue(messages("src/mixture/a-inl.hpp", "#pragma once\n"))

    def test_missing_licence_lines(self):
        for path in ("src/lie/a.cpp", "tools/a.py", "cmake/a.cmake", "src/lie/CMakeLists.txt", "Makefile"):
            self.assertEqual(len(messages(path, "\n", head="")), 2, path)
        self.assertEqual(len(messages("tools/script", "#!/bin/sh\n", head="")), 2)
        self.assertFalse(messages("docs/page.md", "\n", head=""))

    def test_paths_of_one_machine(self):
        for folder in ("work", "root", "home"):
            self.assertTrue(messages("docs/page.md", f"see /{folder}/data\n"), folder)
            self.assertFalse(messages("docs/page.md", f"see https://example.org/{folder}/data\n"))

    def test_data_folder_beside_the_checkout(self):
        folder = "/".join(("..", "shared", "data"))
        for path in ("src/config/a.cpp", "src/app/help.cpp", "python/posemix/a.py", "docs/page.md", "configs/a.toml"):
            self.assertEqual(messages(path, f"// default: {folder}\n"),
                             ["data folder beside the checkout; use --data or POSEMIX_DATA"], path)
        for path in (".ci/run", "Makefile"):
            self.assertFalse(messages(path, f"# {folder}\n"), path)
        self.assertFalse(messages("docs/page.md", "see https://example.org/shared/database\n"))


class Tree(unittest.TestCase):
    def run_main(self, root):
        output = io.StringIO()
        with mock.patch("sys.argv", ["check_includes.py", str(root)]), contextlib.redirect_stdout(output):
            return check_includes.main(), output.getvalue()

    def test_exit_status_and_report(self):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            (root / "src/lie").mkdir(parents=True)
            source = root / "src/lie/a.cpp"
            source.write_text(HEAD, encoding="utf-8")
            (root / "binary.png").write_bytes(b"\x89PNG\xff\xfe")
            self.assertEqual(self.run_main(root), (0, ""))
            source.write_text(HEAD + '#include "posemix/io/a.hpp"\n', encoding="utf-8")
            status, output = self.run_main(root)
            self.assertEqual(status, 1)
            self.assertTrue(output.startswith("src/lie/a.cpp:3: "), output)


if __name__ == "__main__":
    unittest.main()
