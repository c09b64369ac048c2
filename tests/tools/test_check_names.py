# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Tests of tools/check_names.py."""

import contextlib
import io
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
import check_names  # noqa: E402

SCENE = """#include "base/draw.hpp"
namespace posemix::testing {
inline constexpr double kPeriod = 0.1;  ///< between two frames [s]
inline SE3d turn(double deg) {
  const int local = 0;
}
struct Scene {
  int member = 0;
};
}  // namespace posemix::testing
"""
DRAW = "template <typename Scalar>\nstd::vector<Eigen::Matrix<Scalar, 3, 1>> draws(int count) {\n}\nvoid PrintTo(Scene, std::ostream*);\n"
SOURCE = """#include "scene.hpp"
namespace posemix {
namespace {
using namespace testing;
%s
TEST(Scene, Moves) {
  EXPECT_EQ(turn(3.0), SE3d());
}
}  // namespace
}  // namespace posemix
"""


class Names(unittest.TestCase):
    def run_main(self, declaration):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in (("lie/scene.hpp", SCENE), ("base/draw.hpp", DRAW), ("lie/test_scene.cpp", SOURCE % ""),
                               ("lie/test_other.cpp", (SOURCE % declaration).replace('#include "scene.hpp"\n', ""))):
                path = Path(folder, "tests", name)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            output = io.StringIO()
            with mock.patch("sys.argv", ["check_names.py", folder]), contextlib.redirect_stdout(output):
                return check_names.main(), output.getvalue()

    def test_a_name_that_hides_one_of_a_header_that_another_source_includes(self):
        for declaration, name in (("constexpr double kPeriod = 100.0;", "kPeriod"), ("SE3d turn(double angle) {", "turn"),
                                  ("const SE3d kPeriod(SO3d(), {0, 0, 1});", "kPeriod"), ("struct Scene {", "Scene"),
                                  ("using Scene = int;", "Scene")):
            self.assertEqual(self.run_main(declaration), (1, f"tests/lie/test_other.cpp:4: '{name}' hides that of tests/lie/scene.hpp\n"))
        self.assertEqual(self.run_main("std::vector<Vector3d> draws() {"),
                         (1, "tests/lie/test_other.cpp:4: 'draws' hides that of tests/base/draw.hpp\n"))

    def test_names_that_hide_none(self):
        for declaration in ("", "constexpr double kLookPeriod = 100.0;", "int f() {\n  const double kPeriod = 1.0;\n}",
                            "  int member = 0;", "void PrintTo(Other, std::ostream*) {", "// constexpr double kPeriod = 1.0;"):
            self.assertEqual(self.run_main(declaration), (0, ""), declaration)


if __name__ == "__main__":
    unittest.main()
