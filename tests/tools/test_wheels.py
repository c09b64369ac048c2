# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Tests of what tools/make_wheels does to a wheel after it is built."""

import base64
import csv
import hashlib
import importlib.machinery
import importlib.util
import io
import json
import sys
import tempfile
import unittest
import unittest.mock
import zipfile
import zlib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/wheels"))
import dependencies  # noqa: E402
import package  # noqa: E402

loader = importlib.machinery.SourceFileLoader("make_wheels", str(ROOT / "tools/make_wheels"))
make_wheels = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
loader.exec_module(make_wheels)

INFO = "thing-1.2.3.dist-info"
FILES = {"thing/__init__.py": "x = 1\n", "thing-1.2.3.data/scripts/thing": "#!python\n", f"{INFO}/WHEEL": "Wheel-Version: 1.0\n",
         f"{INFO}/METADATA": "Name: thing\n", f"{INFO}/RECORD": "stale\n"}


def built(folder, order, date):
    """A wheel as a build backend writes it."""
    path = Path(folder) / f"{len(list(Path(folder).iterdir()))}.whl"
    with zipfile.ZipFile(path, "w") as archive:
        for name in order:
            entry = zipfile.ZipInfo(name, date)
            entry.external_attr = (0o100777 if "scripts" in name else 0o100640) << 16
            archive.writestr(entry, FILES[name])
    return path


class Libraries(unittest.TestCase):
    def test_all_libraries_are_asked_for(self):
        # The module links all of them, and none is built for the sake of another.
        rooms = sorted(f"posemix_{path.parent.name}" for path in ROOT.glob("src/*/CMakeLists.txt")
                       if "posemix_add_room(" in path.read_text(encoding="utf-8"))
        self.assertEqual(sorted(make_wheels.library_targets()), rooms)


class Wheels(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.out = Path(self.folder.name) / "out"
        self.out.mkdir()
        # Zopfli is of the tools that build wheels, and writes the same format.
        replaced = unittest.mock.patch.object(package, "deflated", lambda content: zlib.compress(content, 9)[2:-4])
        replaced.start()
        self.addCleanup(replaced.stop)
        self.libraries = dependencies.compiled()[:2]
        for library in self.libraries:
            library.version = "1:2.3+dfsg-4"
            library.notice = self.out.parent / f"{library.name}.copyright"
            library.notice.write_text(f"licence of {library.name}\n")

    def complete(self, wheel):
        path = package.complete(wheel, "1.2.3", self.libraries, [("nanobind", "3.0", "BSD-3-Clause")], {"libcxx": b"terms\n"}, self.out)
        content = path.read_bytes()
        path.unlink()
        return content

    def test_the_bytes_do_not_depend_on_order_times_and_permissions_of_the_build(self):
        first = built(self.folder.name, sorted(FILES), (2020, 1, 1, 0, 0, 0))
        second = built(self.folder.name, sorted(FILES, reverse=True), (2024, 2, 2, 2, 2, 2))
        self.assertEqual(self.complete(first), self.complete(second))

    def test_the_record_has_every_file_with_its_hash(self):
        content = self.complete(built(self.folder.name, FILES, (2020, 1, 1, 0, 0, 0)))
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            rows = {row[0]: row[1:] for row in csv.reader(io.StringIO(archive.read(f"{INFO}/RECORD").decode()))}
            self.assertEqual(sorted(rows), sorted(archive.namelist()))
            for name in archive.namelist():
                digest = base64.urlsafe_b64encode(hashlib.sha256(archive.read(name)).digest()).rstrip(b"=").decode()
                self.assertEqual(rows[name], ["", ""] if name.endswith("RECORD") else [f"sha256={digest}", str(len(archive.read(name)))])
            self.assertEqual(archive.getinfo("thing-1.2.3.data/scripts/thing").external_attr >> 16, 0o100755)
            self.assertEqual(archive.getinfo("thing/__init__.py").external_attr >> 16, 0o100644)

    def test_the_bill_of_materials_names_what_is_linked_and_the_licences_are_there(self):
        content = self.complete(built(self.folder.name, FILES, (2020, 1, 1, 0, 0, 0)))
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            bill = json.loads(archive.read(f"{INFO}/sboms/posemix.cdx.json"))
            self.assertEqual(archive.read(f"{INFO}/licenses/{self.libraries[1].name}.txt").decode(),
                             f"licence of {self.libraries[1].name}\n")
            self.assertEqual(archive.read(f"{INFO}/licenses/libcxx.txt"), b"terms\n")
        self.assertEqual((bill["bomFormat"], bill["specVersion"]), ("CycloneDX", "1.6"))
        parts = {part["name"]: part for part in bill["components"]}
        self.assertEqual(set(parts), {"fmt", "nlopt", "nanobind"})
        self.assertEqual(parts["fmt"]["purl"], "pkg:deb/debian/fmtlib@1:2.3%2Bdfsg-4?arch=source")
        self.assertEqual(set(bill["dependencies"][0]["dependsOn"]), {part["bom-ref"] for part in bill["components"]})


if __name__ == "__main__":
    unittest.main()
