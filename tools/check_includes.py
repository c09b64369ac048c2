#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Check the include directions between rooms, the head of every source file, and paths that only some machines have.

A room includes only itself and the rooms before it in ROOMS. Prints every violation as a line
file:line: message, and exits with 1 if there is one.
"""

import argparse
import re
import subprocess
import sys
from pathlib import Path

ROOMS = ("base", "lie", "density", "mixture", "divergence", "reduction", "detector", "filter", "slam", "grasp", "io", "fiducial",
         "config", "draw", "results", "live", "study", "fetch", "app")
LIBRARY_TREES = ("src", "include")
ROOM_TREES = ("src", "tests", "bench")
CPP_SUFFIXES = (".hpp", ".cpp")
SPDX_SUFFIXES = CPP_SUFFIXES + (".py", ".cmake", ".sh", ".ts")
SPDX_NAMES = ("CMakeLists.txt", "Makefile")
SPDX_LINES = ("SPDX-License-Identifier: MIT", "SPDX-FileCopyrightText: posemix contributors")

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
MACHINE_PATH = re.compile(r"(?<![A-Za-z0-9_.~-])/(work|root|home|Users)/")
# The data folder is given by --data, $POSEMIX_DATA or the cache of `posemix data`, never by a path beside the checkout.
SHARED_DATA = re.compile(r"\bshared[/]data\b")
SHARED_DATA_ALLOWED = (".ci/run", "Makefile")


def room_of(path):
    """The room a file belongs to ("testing" for the public test tools), or None."""
    parts = Path(path).parts
    if parts[:2] == ("include", "posemix"):
        parts = parts[1:]
    elif not parts or parts[0] not in ROOM_TREES:
        return None
    if len(parts) < 3:
        return None
    return parts[1] if parts[1] in ROOMS + ("testing",) else None


def included_room(target):
    """The room of an included header, whose path is relative to include/ or to tests/."""
    return room_of(("include/" if target.startswith("posemix/") else "tests/") + target)


def include_error(path, quote, target):
    """The error message for `#include target` in `path`, or None."""
    if ".." in Path(target).parts:
        return f"include '{target}' by its path from include/ or tests/, not relative to this file"
    room = room_of(path)
    included = included_room(target)
    if room is None or included is None and not target.startswith("posemix/"):
        return None
    if quote == "<":
        return f"include own header '{target}' with quotes"
    if included is None:
        return f"'{target}' is in no room ({' '.join(ROOMS)})"
    if included == "testing":
        if Path(path).parts[0] in LIBRARY_TREES and room != "testing":
            return f"the library must not include the test tools '{target}'"
        return None
    if room == "testing":
        return None if included != "app" else f"the test tools must not include '{target}'"
    if ROOMS.index(included) > ROOMS.index(room):
        return f"room '{room}' must not include '{target}': '{included}' comes after it"
    return None


def check_cpp(path, lines):
    for number, line in enumerate(lines, 1):
        match = INCLUDE.match(line)
        message = match and include_error(path, match[1], match[2])
        if message:
            yield number, message
    # NAME-inl.hpp has Highway's guard, because it is compiled once for every set of vector instructions.
    guard = "HWY_TARGET_TOGGLE" if path.endswith("-inl.hpp") else "#pragma once"
    if Path(path).suffix == ".hpp" and not any(guard in line for line in lines):
        yield 1, f"header without {guard}"


def needs_spdx(path, lines):
    name = Path(path)
    return (name.suffix in SPDX_SUFFIXES or name.name in SPDX_NAMES
            or bool(lines) and lines[0].startswith("#!"))


def check_file(path, text):
    """Yields (line number, message) for every violation in the file at `path` (relative to the root)."""
    lines = text.splitlines()
    if Path(path).suffix in CPP_SUFFIXES:
        yield from check_cpp(path, lines)
    if needs_spdx(path, lines):
        head = "\n".join(lines[:3])
        yield from ((1, f"missing '{line}' at the head") for line in SPDX_LINES if line not in head)
    for number, line in enumerate(lines, 1):
        if MACHINE_PATH.search(line):
            yield number, "path of one machine"
        if SHARED_DATA.search(line) and path not in SHARED_DATA_ALLOWED:
            yield number, "data folder beside the checkout; use --data or POSEMIX_DATA"


def project_files(root):
    """Tracked and new files of the checkout at `root`; all files if it is not a git checkout."""
    command = ["git", "-C", str(root), "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    if (root / ".git").exists():
        names = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split("\0")
        return sorted(name for name in names if name and (root / name).is_file())
    return sorted(str(path.relative_to(root)) for path in root.rglob("*") if path.is_file())


def check_tree(root):
    """Yields one line of text for every violation under `root`."""
    for name in project_files(root):
        try:
            text = (root / name).read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        for number, message in check_file(name, text):
            yield f"{name}:{number}: {message}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("root", nargs="?", type=Path, default=Path(__file__).resolve().parent.parent)
    violations = list(check_tree(parser.parse_args().root))
    print(*violations, sep="\n", end="\n" if violations else "")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
