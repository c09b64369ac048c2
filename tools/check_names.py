#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Check that no name in an unnamed namespace of a test hides one of the tests' headers.

The sources of a test program are compiled together: what one of them names in its unnamed namespace is found, in all that
come after it, before the name that they mean of a header of namespace testing, and nothing warns where both fit. Prints
every such name as a line file:line: message, and exits with 1 if there is one.
"""

import argparse
import re
import sys
from pathlib import Path

INCLUDE = re.compile(r'^#include "([^"]+)"', re.MULTILINE)
UNNAMED = re.compile(r"^namespace \{$(.*?)^\}  // namespace$", re.MULTILINE | re.DOTALL)
# Overloaded by intent: the printing of values by GoogleTest.
OVERLOADED = {"PrintTo"}
# A function, a constant or a type that begins a line: clang-format indents all that is not at the scope of a namespace.
DECLARED = re.compile(
    r"^(?:struct|class|enum class|using(?! namespace)) (?P<type>\w+)\b(?!::)|"
    r"^(?!using |namespace |return |#|//|[\s})])[\w:<>,*& ]*?[\w>*&] [*&]?(?P<name>\w+) ?(?:[({;]|= )", re.MULTILINE)


def declared(text):
    """Name and place of all that is declared at the scope of a namespace."""
    for match in DECLARED.finditer(text):
        yield match["type"] or match["name"], match.start()


def headers_of(path, root):
    """The headers below tests/ that a file includes, and those that these include."""
    found, waiting = set(), [path]
    while waiting:
        file = waiting.pop()
        for name in INCLUDE.findall(file.read_text(encoding="utf-8")):
            for header in (file.parent / name, root / "tests" / name):
                if header.is_file() and header not in found:
                    found.add(header)
                    waiting.append(header)
    return found


def check_room(folder, root):
    """Yields a line of text for every name of a source that a header of the same program has."""
    sources = sorted(folder.glob("*.cpp"))
    headers = set().union(*(headers_of(source, root) for source in sources))
    names = {name: header for header in sorted(headers) for name, _ in declared(header.read_text(encoding="utf-8"))}
    for source in sources:
        text = source.read_text(encoding="utf-8")
        for part in UNNAMED.finditer(text):
            for name, place in declared(part[1]):
                if name in names and name not in OVERLOADED:
                    line = text.count("\n", 0, part.start(1) + place) + 1
                    yield f"{source.relative_to(root)}:{line}: '{name}' hides that of {names[name].relative_to(root)}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("root", nargs="?", type=Path, default=Path(__file__).resolve().parent.parent)
    root = parser.parse_args().root
    violations = [line for folder in sorted(root.glob("tests/*/")) for line in check_room(folder, root)]
    print(*violations, sep="\n", end="\n" if violations else "")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
