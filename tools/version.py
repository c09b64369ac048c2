#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Check that the version is the same everywhere, or set it.

It stands in CMakeLists.txt, which the program, the libraries, the packages and the report read. CITATION.cff states it too,
for those who only see that file, and CHANGELOG.md begins with the changes of this version and its date, or with those of the
next one: `## Unreleased (0.3.0)`. Prints the version, or every contradiction, and exits with 1 if there is one.
"""

import argparse
import re
import sys
from datetime import date
from pathlib import Path

NUMBER = r"\d+\.\d+\.\d+"
DATE = r"\d{4}-\d{2}-\d{2}"
PROJECT = re.compile(rf"(project\(posemix VERSION )({NUMBER})\b")
CITATION = re.compile(rf"^(version: )(\S+)$(?:\n(date-released: )(\S+)$)?", re.MULTILINE)
SECTION = re.compile(rf"^## (?:Unreleased \(({NUMBER})\)|({NUMBER}) \(({DATE})\))$", re.MULTILINE)
FILES = ("CMakeLists.txt", "CITATION.cff", "CHANGELOG.md")


def parts(version):
    return [int(part) for part in version.split(".")]


def contradictions(cmake, citation, changelog, release):
    """The version, and a line of text for everything that does not agree with it."""
    version = PROJECT.search(cmake)
    if not version:
        return None, ["CMakeLists.txt: expected project(posemix VERSION x.y.z"]
    version = version[2]
    errors = []
    cited = CITATION.search(citation)
    if not cited or cited[2] != version:
        errors.append(f"CITATION.cff: got version {cited and cited[2]}, expected {version} as in CMakeLists.txt")
    first = re.search(r"^## .*$", changelog, re.MULTILINE)
    section = first and SECTION.fullmatch(first[0])
    if not section:
        errors.append(f"CHANGELOG.md: got first section {first and first[0]!r}, expected '## Unreleased (x.y.z)' or "
                      f"'## {version} (date)'")
    elif section[1] and release:
        errors.append(f"CHANGELOG.md: the first section is unreleased; run tools/version.py --set {section[1]}")
    elif section[1] and parts(section[1]) <= parts(version):
        errors.append(f"CHANGELOG.md: got unreleased {section[1]}, expected a version after {version} of CMakeLists.txt")
    elif section[2] and section[2] != version:
        errors.append(f"CHANGELOG.md: got first section {section[2]}, expected {version} as in CMakeLists.txt")
    elif section[2] and cited and cited[4] != section[3]:
        errors.append(f"CITATION.cff: got date-released {cited[4]}, expected {section[3]} as in CHANGELOG.md")
    return version, errors


def changed(cmake, citation, changelog, version, day):
    """The three texts with another version, and with a section of the changelog that is released on a date."""
    cmake = PROJECT.sub(rf"\g<1>{version}", cmake)
    citation = CITATION.sub(f"version: {version}\ndate-released: {day}", citation, count=1)
    section = SECTION.search(changelog)
    if section and section[1]:
        changelog = changelog.replace(section[0], f"## {version} ({day})", 1)
    return cmake, citation, changelog


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parent.parent)
    parser.add_argument("--release", action="store_true", help="the changes of this version have to have a date")
    parser.add_argument("--set", metavar="X.Y.Z", help="set the version, and the date of its section in CHANGELOG.md")
    parser.add_argument("--date", metavar="YYYY-MM-DD", help="that date")
    options = parser.parse_args()
    if options.set and not (re.fullmatch(NUMBER, options.set) and re.fullmatch(DATE, options.date or "")):
        parser.error("expected --set X.Y.Z --date YYYY-MM-DD")
    texts = [(options.root / name).read_text() for name in FILES]
    if options.set:
        try:
            date.fromisoformat(options.date)
        except ValueError as error:
            parser.error(f"--date: {error}")
        section = SECTION.search(texts[2])
        if section and section[1] not in (None, options.set):
            parser.error(f"CHANGELOG.md begins with what is unreleased of {section[1]}, not of {options.set}")
        texts = changed(*texts, options.set, options.date)
        errors = contradictions(*texts, options.release)[1]
        if errors:  # and nothing is written
            print(*errors, sep="\n")
            return 1
        for name, text in zip(FILES, texts):
            (options.root / name).write_text(text)
    version, errors = contradictions(*texts, options.release)
    print(*errors or [version], sep="\n")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
