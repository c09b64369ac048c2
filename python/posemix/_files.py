# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Text files: errors name the file, and a file is written as a whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO


def read_text(path: str | os.PathLike[str]) -> str:
    """The text of a file; raises ValueError if it is not UTF-8."""
    try:
        return Path(path).read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise ValueError(f"{os.fspath(path)}: is not a text file (UTF-8)") from error


def numbered_lines(text: str) -> Iterator[tuple[int, str]]:
    """Numbers (from one) and contents of the lines that are not blank and do not start with #."""
    for number, line in enumerate(text.splitlines(), start=1):
        stripped = line.strip()
        if stripped and not stripped.startswith("#"):
            yield number, stripped


def numbers(fields: list[str], count: int, where: str) -> list[float]:
    """The fields as `count` finite numbers; raises ValueError naming the place."""
    if len(fields) != count:
        raise ValueError(f"{where}: got {len(fields)} numbers, expected {count}")
    values = []
    for field in fields:
        try:
            value = float(field)
        except ValueError:
            raise ValueError(f"{where}: got '{field}', expected a number") from None
        if value - value != 0.0:
            raise ValueError(f"{where}: got '{field}', expected a finite number")
        values.append(value)
    return values


@contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[TextIO]:
    """A file to write beside `path`, which takes its place at the end; after an exception all is as it was."""
    target = Path(path)
    handle, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
    try:
        with os.fdopen(handle, "w", encoding="utf-8", newline="\n") as file:
            yield file
        os.chmod(name, 0o644)
        os.replace(name, target)
    except BaseException:
        os.unlink(name)
        raise


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Writes a file as a whole or not at all."""
    with whole_file(path) as file:
        file.write(text)
