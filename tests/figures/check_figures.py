#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Check that the figures of studies and runs are those of tests/figures/expected.

usage: check_figures.py PROGRAM EXPECTED                 compare with the recorded figures, to 1e-6 relative
       check_figures.py PROGRAM EXPECTED --record        record them anew
       check_figures.py PROGRAM OTHER_PROGRAM --exact    compare two programs bit for bit, on one machine

The program runs with POSEMIX_SIMD=portable, so that its figures are the same on all machines: where costs are nearly equal,
the last digit decides which hypotheses the paper's filter merges, and some of its errors then differ by a thousandth. They are
recorded to 1e-6, as another version of the C library may round differently. Runs on recordings need the environment variable POSEMIX_DATA; without it they are
skipped, or fail where CI=true.
"""

import argparse
import csv
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TOLERANCE = 1e-6
# Name, whether it needs recordings, arguments before --out.
STUDIES = [
    ("monte-carlo", False, ["study", "monte-carlo", "--set", "runs=4"]),
    ("divergence", False, ["study", "divergence"]),
    ("salt-box", False, ["study", "salt-box"]),
    ("ycbv", True, ["study", "ycbv", "--set", 'methods=["default", "midway", "riekf"]']),
    ("tless", True, ["study", "tless"]),
    ("fuse-views", True, ["study", "fuse-views", "--set", 'datasets=["ycbv"]', "--set", "scenes=[54]"]),
    ("noise", True, ["study", "noise", "--set", "frame=ray", "--set", "max_components=2", "--set", "restarts=2",
                     "--set", "folds=2"]),
]
RUNS = [
    ("0022", True, ["slam", str(ROOT / "configs/ycbv-0022.toml")]),
    ("0022-paper", True, ["slam", str(ROOT / "configs/ycbv-0022-paper.toml")]),
]
TIMES = ("_us", "_ms", "_s_per_frame", "seconds")
# Of metrics.json: digests tell the last digit, and the program's own command and files are no figures.
ORIGIN = ("run", "files", "provenance")


def run(program, arguments, out):
    command = [str(program), *arguments, "--out", str(out), "--quiet"]
    portable = {**os.environ, "POSEMIX_SIMD": "portable"}
    result = subprocess.run(command, capture_output=True, text=True, env=portable)
    if result.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit code {result.returncode}\n{result.stderr}")


def leaves(value, path=""):
    """Path and value of every leaf of a JSON document, without times."""
    if isinstance(value, dict):
        for key, inner in value.items():
            if not key.endswith(TIMES) and (path or key not in ORIGIN):
                yield from leaves(inner, f"{path}/{key}")
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from leaves(inner, f"{path}/{i}")
    else:
        yield path, value


def figures_of(program, name, arguments, folder):
    """Tables of strings by file name."""
    out = Path(folder) / name
    run(program, arguments, out)
    tables = {}
    for path in sorted(out.glob("*.csv")):
        if path.name != "timing.csv":
            with path.open(newline="", encoding="utf-8") as file:
                tables[path.name] = list(csv.reader(file))
    metrics = out / "metrics.json"
    if metrics.is_file():
        document = json.loads(metrics.read_text(encoding="utf-8"))
        tables["metrics.csv"] = [[path, str(value)] for path, value in leaves(document)]
    return without_times(tables)


def without_times(tables):
    for rows in tables.values():
        kept = [i for i, name in enumerate(rows[0]) if not name.endswith(TIMES)]
        rows[:] = [[row[i] for i in kept] for row in rows]
    return tables


def agree(expected, actual, exact):
    if expected == actual:
        return True
    if exact:
        return False
    try:
        a, b = float(expected), float(actual)
    except ValueError:
        return False
    return math.isclose(a, b, rel_tol=TOLERANCE, abs_tol=1e-12)


def differences(name, expected, actual, exact=False):
    """One line of text per cell that differs."""
    for file in sorted(set(expected) | set(actual)):
        if file not in expected or file not in actual:
            yield f"{name}/{file}: only in one of the two"
            continue
        before, now = expected[file], actual[file]
        if len(before) != len(now):
            yield f"{name}/{file}: {len(now)} rows, expected {len(before)}"
            continue
        for number, (old, new) in enumerate(zip(before, now), 1):
            if len(old) != len(new):
                yield f"{name}/{file}:{number}: {len(new)} cells, expected {len(old)}"
            for column, (a, b) in enumerate(zip(old, new)):
                if not agree(a, b, exact):
                    yield f"{name}/{file}:{number}: {before[0][column]}: {b}, expected {a}"


def read_expected(folder):
    tables = {}
    for path in sorted(folder.glob("*.csv")):
        with path.open(newline="", encoding="utf-8") as file:
            tables[path.name] = list(csv.reader(file))
    return tables


def record(folder, tables):
    folder.mkdir(parents=True, exist_ok=True)
    for name, rows in tables.items():
        with (folder / name).open("w", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("expected", type=Path)
    parser.add_argument("--record", action="store_true")
    parser.add_argument("--exact", action="store_true")
    options = parser.parse_args()
    has_data = Path(os.environ.get("POSEMIX_DATA", "")).is_dir() and "POSEMIX_DATA" in os.environ
    if not has_data and os.environ.get("CI") == "true":
        sys.exit("recordings are mandatory here: set POSEMIX_DATA to their folder")
    wrong, compared = [], 0
    with tempfile.TemporaryDirectory() as scratch:
        for name, needs_data, arguments in STUDIES + RUNS:
            if needs_data and not has_data:
                print(f"{name}: skipped, no recordings: set POSEMIX_DATA to their folder")
                continue
            actual = figures_of(options.program, name, arguments, Path(scratch) / "a")
            if options.record:
                record(options.expected / name, actual)
                continue
            expected = (figures_of(options.expected, name, arguments, Path(scratch) / "b") if options.exact
                        else read_expected(options.expected / name))
            wrong += differences(name, expected, actual, options.exact)
            compared += sum(len(row) for rows in actual.values() for row in rows)
    print(*wrong[:100], sep="\n", end="\n" if wrong else "")
    print(f"{compared} cells compared, {len(wrong)} differ")
    return 1 if wrong or not (compared or options.record) else 0


if __name__ == "__main__":
    sys.exit(main())
