#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Write include/posemix/<room>.hpp, the header that includes all public headers of a room.

usage: tools/umbrella_headers.py [--check]     with --check nothing is written, and stale headers are an error
"""

import argparse
import sys
from pathlib import Path

PUBLIC = Path(__file__).resolve().parent.parent / "include" / "posemix"
ELSEWHERE = ("testing",)  # has no umbrella header: it needs GoogleTest and RapidCheck, and is included header by header


def text_of(room):
    includes = "\n".join(f'#include "posemix/{room.name}/{path.name}"' for path in sorted(room.glob("*.hpp")))
    return f"""// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

/// Everything of the room `{room.name}`.
{includes}
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true")
    check = parser.parse_args().check
    wanted = {PUBLIC / f"{room.name}.hpp": text_of(room) for room in sorted(PUBLIC.iterdir())
              if room.is_dir() and room.name not in ELSEWHERE and any(room.glob("*.hpp"))}
    stale = [path for path in PUBLIC.glob("*.hpp") if path not in wanted]
    stale += [path for path, text in wanted.items() if not path.is_file() or path.read_text(encoding="utf-8") != text]
    if check:
        for path in stale:
            print(f"{path.relative_to(PUBLIC.parent.parent)}: stale; run tools/umbrella_headers.py")
        return 1 if stale else 0
    for path in stale:
        if path in wanted:
            path.write_text(wanted[path], encoding="utf-8")
        else:
            path.unlink()
    return 0


if __name__ == "__main__":
    sys.exit(main())
