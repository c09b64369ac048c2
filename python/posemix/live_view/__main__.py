# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The report of a recording that lies there: python -m posemix.live_view FOLDER, also of a program that was cut off."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from posemix._core import write_report
from posemix.live_view.trace import FRAMES, write_results


def main(arguments: list[str] | None = None) -> int:
    """Writes results and report of a folder into it."""
    parser = argparse.ArgumentParser(prog="python -m posemix.live_view", description=__doc__)
    parser.add_argument("folder", type=Path, help="folder of a LiveRecording")
    parser.add_argument("--title", help="title of the page")
    options = parser.parse_args(arguments)
    try:
        with (options.folder / FRAMES).open(encoding="utf-8") as file:
            write_results(options.folder, file, sys.maxsize)
        print(write_report(options.folder, None, options.title))
    except (ValueError, OSError) as error:
        print(f"posemix.live_view: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
