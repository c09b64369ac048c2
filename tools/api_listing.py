#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Compare what users may rely on with the listing of it, docs/api/cpp.txt or docs/api/python.txt.

    tools/api_listing.py cpp                      # names and signatures of the public headers, as doxygen reads them
    build/venv/bin/python tools/api_listing.py python           # of the package that this Python has
    ... --update                                  # add what is new to the listing
    ... --update --breaking                       # and take out what is gone: only on the way to the next minor version

A line that is gone from the code is a broken promise (docs/compatibility.md), one that is not in the listing yet an addition.
"""

import argparse
import re
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "api"))
SOURCE = HERE.parent
HEAD = "# The public API of posemix {}; see docs/compatibility.md. Written by tools/api_listing.py.\n"


def next_minor():
    """Major and minor number of the version that is worked on: that of the first section of the changelog."""
    section = re.search(r"^## (?:Unreleased \()?(\d+\.\d+)\.\d+", (SOURCE / "CHANGELOG.md").read_text(), re.MULTILINE)
    return section[1]


def read_listing(path):
    """Version and lines of a listing."""
    if not path.exists():
        return next_minor(), []
    head, *lines = path.read_text().splitlines()
    return re.search(r"posemix (\d+\.\d+)", head)[1], lines


def differences(listed, found):
    return [line for line in listed if line not in set(found)], [line for line in found if line not in set(listed)]


def update(path, listed, found, version, breaking):
    """Write the listing; what is gone stays in unless it may go."""
    gone, _ = differences(listed, found)
    if gone and not breaking:
        return [f"gone: {line}" for line in gone] + ["these are promised; with --breaking they are taken out of the listing"]
    if gone and version == next_minor():
        return [f"gone: {line}" for line in gone] + [
            f"posemix {version} promises these; the changelog has to begin with a later minor version, '## Unreleased (x.y.0)'"]
    path.parent.mkdir(exist_ok=True)
    path.write_text(HEAD.format(next_minor()) + "".join(f"{line}\n" for line in found))
    return []


def compare(listed, found, command):
    gone, new = differences(listed, found)
    errors = [f"gone: {line}" for line in gone] + [f"new: {line}" for line in new]
    if gone:
        errors.append("What is gone or has another signature was promised (docs/compatibility.md): keep it, "
                      "or see how a version may break it.")
    if new and not gone:
        errors.append(f"New names are added to the listing by: {command} --update")
    return errors


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("language", choices=("cpp", "python"))
    parser.add_argument("--listing", type=Path, help="another file than docs/api/LANGUAGE.txt")
    parser.add_argument("--update", action="store_true")
    parser.add_argument("--breaking", action="store_true")
    options = parser.parse_args(arguments)
    path = options.listing or SOURCE / f"docs/api/{options.language}.txt"
    if options.language == "cpp":
        from cpp_names import public_names
        found = sorted(set(public_names(SOURCE / "include/posemix")))
    else:
        from python_names import public_names
        found = sorted(set(public_names("posemix")))
    version, listed = read_listing(path)
    if options.update:
        errors = update(path, listed, found, version, options.breaking)
    else:
        program = "tools/api_listing.py" if options.language == "cpp" else "build/venv/bin/python tools/api_listing.py"
        errors = compare(listed, found, f"{program} {options.language}")
    print(*errors or [f"{path.name}: {len(found)} names"], sep="\n")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
