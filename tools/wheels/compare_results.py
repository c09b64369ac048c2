# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Compare the numbers of one run on two machines: python compare_results.py FOLDER FOLDER TOLERANCE

Of text and JSON files every number is compared, with a tolerance that is relative above one and absolute below, and every word.
Provenance, timing and digests, which tell of the machine or of last digits, are left out, and so are pages and pictures,
which are made of the rest.
"""

import json
import re
import sys
from pathlib import Path

NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


def leaves(value, name=""):
    """Numbers and words of a JSON document, each with its place."""
    if isinstance(value, dict):
        for key in value:
            if key not in ("provenance", "timing", "run", "files"):
                yield from leaves(value[key], f"{name}.{key}")
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from leaves(item, f"{name}[{index}]")
    else:
        yield name, value


def contents(path):
    """Numbers and words of a file."""
    text = path.read_text()
    if path.suffix == ".json":
        return list(leaves(json.loads(text)))
    return [(f"line {row}, word {column}", float(word) if NUMBER.fullmatch(word) else word)
            for row, line in enumerate(text.splitlines(), 1) for column, word in enumerate(re.split(r"[\s,]+", line.strip()), 1)]


def compare(a, b, tolerance):
    """Largest difference of the numbers of two files, with its place."""
    found, other = contents(a), contents(b)
    if [name for name, _ in found] != [name for name, _ in other]:
        sys.exit(f"{a} and {b}: other places of values")
    worst = (0.0, "", 0)
    for (name, x), (_, y) in zip(found, other, strict=True):
        numbers = [isinstance(value, (int, float)) and not isinstance(value, bool) for value in (x, y)]
        if not all(numbers):
            if x != y:
                sys.exit(f"{a} and {b}, {name}: got {x!r} and {y!r}")
            continue
        difference = abs(x - y) / max(1.0, abs(x))
        if not difference <= tolerance:
            sys.exit(f"{a} and {b}, {name}: got {x!r} and {y!r}, expected at most {tolerance:g} between them")
        worst = max(worst, (difference, name, len(found)))
    return worst[0], len(found)


def main():
    first, second, tolerance = Path(sys.argv[1]), Path(sys.argv[2]), float(sys.argv[3])
    files = sorted(path.relative_to(first) for path in first.rglob("*") if path.suffix in (".tum", ".txt", ".csv", ".json", ".toml"))
    if not files:
        sys.exit(f"{first}: no files to compare")
    results = [compare(first / file, second / file, tolerance) for file in files]
    print(f"{len(files)} files, {sum(count for _, count in results)} values: differences of at most {max(worst for worst, _ in results):.1e}")


if __name__ == "__main__":
    main()
