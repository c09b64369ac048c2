#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Print the files that clang-tidy runs on, one a line: those of the compile commands of a build folder.

A file of a unity build stands for the sources that it includes, which saves most of the time: headers are parsed once
for all of them. With --since only the files that are needed for what has changed since a commit: those with a changed
source, and for every changed header that none of them includes the first one that does.
"""

import argparse
import json
import re
import subprocess
import sys
from pathlib import Path

INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)


def included_files(path, folders):
    """The files that one file includes with quotes, by their path or relative to it or to one of the folders."""
    for name in INCLUDE.findall(path.read_text(encoding="utf-8")):
        yield from (folder / name for folder in (path.parent, *folders) if (folder / name).is_file())


def closure(unit, folders):
    """All files that a unit is made of, itself among them."""
    found, waiting = set(), [unit]
    while waiting:
        path = waiting.pop().resolve()
        if path not in found:
            found.add(path)
            waiting += included_files(path, folders)
    return found


def units_for(changed, units, folders):
    """Those of the units, in their order, that are needed to see all changed files that any of them includes."""
    sources = {path for path in changed if path.suffix == ".cpp"}
    parts = {unit: closure(unit, folders) for unit in units}
    chosen = [unit for unit in units if parts[unit] & sources]
    missing = set(changed) - sources - set().union(*(parts[unit] for unit in chosen))
    for unit in units:
        if unit not in chosen and parts[unit] & missing:
            chosen.append(unit)
            missing -= parts[unit]
    return [unit for unit in units if unit in chosen]


def compiled_files(build):
    """The C++ files of compile_commands.json; those in C are made from descriptions of messages."""
    commands = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    files = {Path(entry["directory"], entry["file"]) for entry in commands}
    return sorted(path for path in files if path.suffix != ".c")


def changed_files(root, commit):
    """Sources and headers that differ from those of the commit."""
    command = ["git", "-C", str(root), "diff", "--name-only", "--diff-filter=d", commit, "--", "src", "include"]
    names = subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()
    return {(root / name).resolve() for name in names if name.endswith((".cpp", ".hpp"))}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path, metavar="BUILD", help="folder with compile_commands.json")
    parser.add_argument("--since", metavar="COMMIT", help="only what is needed for the files changed since")
    options = parser.parse_args()
    root = Path(__file__).resolve().parent.parent
    units = compiled_files(options.build)
    if options.since:
        units = units_for(changed_files(root, options.since), units, [root / "include", root / "src"])
    print(*units, sep="\n", end="\n" if units else "")
    return 0


if __name__ == "__main__":
    sys.exit(main())
