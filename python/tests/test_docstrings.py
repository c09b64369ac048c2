# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Docstrings are phrases that stand for themselves."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator

import posemix as px
import pytest

# A text that begins so needs the name of its field to be understood.
FRAGMENT = re.compile(r"(Of|As|What|How|That|By|From|With|For|In|On|To|Over|Where|Which|And|Its|Else|So|Up)\b")


def texts_of(cls: type) -> Iterator[tuple[str, str]]:
    """Names and docstrings of a class, its attributes and, for an enum, its members."""
    yield cls.__name__, cls.__doc__ or ""
    for name, value in vars(cls).items():
        if name.startswith("_"):
            continue
        if isinstance(value, (property, cls)):
            yield f"{cls.__name__}.{name}", value.__doc__ or ""
    for name, text in re.findall(r"^(\w+) : [^\n]*\n    (.*)", cls.__doc__ or "", re.MULTILINE):
        yield f"{cls.__name__}.{name} (Attributes)", text


CLASSES = [value for name, value in vars(px).items() if inspect.isclass(value) and not name.startswith("_")]


@pytest.mark.parametrize("cls", CLASSES, ids=lambda cls: cls.__name__)
def test_texts_are_phrases(cls: type) -> None:
    for name, text in texts_of(cls):
        assert text, f"{name} has no text"
        assert not FRAGMENT.match(text), f"{name} begins as a fragment: {text}"


def test_functions_say_what_they_do() -> None:
    for name, value in vars(px).items():
        if callable(value) and not inspect.isclass(value) and not name.startswith("_"):
            text = value.__doc__ or ""
            if text.startswith(f"{name}("):  # nanobind puts the signature first
                text = text.split("\n\n", 1)[-1]
            assert text and not FRAGMENT.match(text.strip()), f"{name}: {text}"
