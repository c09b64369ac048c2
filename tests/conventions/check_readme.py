#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Checks that the C++ example of README.md is the body of examples/quickstart.cpp, up to indentation."""

import pathlib
import re
import sys
import textwrap


def main() -> int:
    root = pathlib.Path(sys.argv[1])
    shown = re.search(r"```cpp\n(.*?)```", (root / "README.md").read_text(), re.S)
    body = re.search(r"int main\(\) \{\n(.*)^\}", (root / "examples/quickstart.cpp").read_text(), re.S | re.M)
    if shown is None or body is None:
        print("README.md has no C++ example, or examples/quickstart.cpp no main")
        return 1
    if shown.group(1) != textwrap.dedent(body.group(1)):
        print("the example in README.md differs from examples/quickstart.cpp")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
