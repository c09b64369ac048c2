# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The public headers are those that the listing promises, and the listing notices every change."""

import contextlib
import io
import shutil
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import api_listing  # noqa: E402

HEADER = """#pragma once
#define POSEMIX_HELPER(T) T twice(T x)
namespace posemix {
/// Doubles.
POSEMIX_HELPER(double);
template <typename T> struct Pair { T first; T second = T(0); bool both() const; private: T hidden; };
enum class Colour { red, green };
namespace internal { void secret(); }
}
"""


@unittest.skipUnless(shutil.which("doxygen"), "doxygen reads the headers")
class ApiListing(unittest.TestCase):
    def names(self, text):
        from cpp_names import public_names

        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "posemix").mkdir()
            (Path(folder) / "posemix/pair.hpp").write_text(text)
            return sorted(set(public_names(Path(folder) / "posemix")))

    def compare(self, changed):
        return "\n".join(api_listing.compare(self.names(HEADER), self.names(changed), "tools/api_listing.py cpp"))

    def test_names_and_signatures_are_listed_without_what_is_private(self):
        self.assertEqual(self.names(HEADER), [
            '#include "posemix/pair.hpp"', "T posemix::Pair::first", "T posemix::Pair::second", "bool posemix::Pair::both() const",
            "double posemix::twice(double x)", "enum posemix::Colour", "enum posemix::Colour::green", "enum posemix::Colour::red",
            "template <typename T> struct posemix::Pair"])

    def test_nothing_is_said_without_a_change(self):
        self.assertEqual(self.compare(HEADER.replace("Doubles", "Twice").replace("secret", "other")), "")

    def test_a_removed_or_changed_name_is_a_broken_promise(self):
        for old, new in (("bool both() const;", ""), ("bool both", "int both"), ("red, ", ""), ("(T x)", "(T x, int y)")):
            self.assertIn("promised", self.compare(HEADER.replace(old, new)), new)

    def test_a_new_name_asks_for_an_update(self):
        text = self.compare(HEADER.replace("red,", "red, blue,"))
        self.assertIn("new: enum posemix::Colour::blue", text)
        self.assertIn("tools/api_listing.py cpp --update", text)
        self.assertNotIn("promised", text)

    def test_an_update_takes_out_names_on_the_way_to_the_next_minor_version_only(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "listing.txt"
            now = api_listing.next_minor()
            self.assertEqual(api_listing.update(path, [], ["a", "b"], now, False), [])
            self.assertEqual(api_listing.read_listing(path), (now, ["a", "b"]))
            self.assertTrue(api_listing.update(path, ["a", "b"], ["a"], now, False))
            self.assertTrue(api_listing.update(path, ["a", "b"], ["a"], now, True))
            self.assertEqual(api_listing.read_listing(path), (now, ["a", "b"]))
            self.assertEqual(api_listing.update(path, ["a", "b"], ["a"], "0.1", True), [])
            self.assertEqual(api_listing.read_listing(path), (now, ["a"]))

    def test_the_headers_of_this_checkout_are_as_listed(self):
        text = io.StringIO()
        with contextlib.redirect_stdout(text):
            status = api_listing.main(["cpp"])
        self.assertEqual(status, 0, text.getvalue())


if __name__ == "__main__":
    unittest.main()
