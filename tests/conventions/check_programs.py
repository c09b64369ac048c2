#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Runs the examples of docs/programs.md, each `sh` block in turn, and compares what they print with the `text` block
that follows: words must be the same, numbers agree to 1 part in 1000.

Usage: check_programs.py SOURCE_FOLDER PROGRAM"""

import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile

NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?$")


def same(got: str, shown: str) -> bool:
    if NUMBER.match(got) and NUMBER.match(shown):
        return math.isclose(float(got), float(shown), rel_tol=1e-3, abs_tol=1e-7)
    return got == shown


def words(text: str) -> list[str]:
    return re.split(r"[\s,\[\]]+", text.strip())


def main() -> int:
    root, program = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    blocks = re.findall(r"```(\w+)\n(.*?)```", (root / "docs/programs.md").read_text(), re.S)
    with tempfile.TemporaryDirectory() as folder:
        environment = dict(os.environ, PATH=f"{program.parent}:{os.environ['PATH']}")
        printed, failures = "", 0
        for kind, text in blocks:
            if kind == "sh":
                run = subprocess.run(["bash", "-euo", "pipefail", "-c", text], cwd=folder, env=environment,
                                     stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
                printed = run.stdout
                if run.returncode != 0:
                    print(f"exit code {run.returncode} of\n{text}\n{printed}")
                    return 1
            elif kind == "text":
                got, shown = words(printed), words(text)
                if len(got) != len(shown) or not all(map(same, got, shown)):
                    print(f"shown:\n{text}\nprinted:\n{printed}")
                    failures += 1
    if not blocks:
        print("docs/programs.md has no examples")
    return 0 if blocks and failures == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
