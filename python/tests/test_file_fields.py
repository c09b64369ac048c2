# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Every field of settings that a file can set is read by the function for its table, and stands in its documents."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from file_places import ASSOCIATION, IN_FILES, MODEL, NOISE, NOT_IN_FILES, WITHOUT_FILE, Place
from test_fields import ROOT, STRUCTS, closing, without_comments

CONFIG = ROOT / "src" / "config"


def functions(reader: str) -> str:
    """The text of the functions that a `Place` names, without comments and without errors on keys."""
    name, *wanted = reader.split()
    text = without_comments((CONFIG / name).read_text())
    bodies = [] if wanted else [text]
    for function in wanted:
        found = re.search(rf"^\S[^;{{}}]*\b{function}\([^;{{]*\) \{{", text, re.MULTILINE)
        assert found, f"src/config/{name} has no function {function}"
        bodies.append(text[found.start() : closing(text, found.end() - 1)])
    return re.sub(r"\bfail\(\s*\"\w+\"", "", "".join(bodies))


def reads(text: str, key: str) -> bool:
    return f'"{key}"' in text


def section_of(page: str, heading: str) -> list[str]:
    """The lines of a section of a document, without its subsections."""
    parts = re.split(r"^#+ (.*)$", page, flags=re.MULTILINE)
    assert heading in parts[1::2], f"there is no section {heading}"
    return parts[2 * parts[1::2].index(heading) + 2].splitlines()


def cells_with(lines: list[str], key: str) -> list[str]:
    """Rows of tables whose first column has the key, alone or as a part of a dotted one."""
    rows = [line for line in lines if line.startswith("|")]
    names = [re.findall(r"`([^`]+)`", row.split("|")[1]) for row in rows]
    fits = re.compile(rf"(?:.+\.)?{re.escape(key)}(?:\..+)?")
    return [row for row, words in zip(rows, names, strict=True) if any(fits.fullmatch(word) for word in words)]


def documents(lines: list[str], place: Place, key: str) -> bool:
    if not place.row and not place.prose:
        return bool(cells_with(lines, key))
    within = cells_with(lines, place.row) if place.row else ["\n".join(x for x in lines if not x.startswith("|"))]
    return any(re.search(rf"`[^`]*\b{key}\b[^`]*`", text) for text in within)


def places() -> list[tuple[str, str, Place]]:
    """Field, key and place of every field that a file sets."""
    found = []
    for name, (usual, others) in IN_FILES.items():
        for field in STRUCTS[name]:
            if f"{name}.{field}" in NOT_IN_FILES:
                continue
            other = others.get(field, field)
            keys, place = other if isinstance(other, tuple) else (other, usual)
            found += [(f"{name}.{field}", key, place) for key in ([keys] if isinstance(keys, str) else keys)]
    return found


@pytest.mark.parametrize(("field", "key", "place"), places(), ids=lambda part: part if isinstance(part, str) else "")
def test_a_setting_is_read_and_documented(field: str, key: str, place: Place) -> None:
    assert reads(functions(place.reader), key), f"no file sets {field}: {place.reader} does not read '{key}'"
    lines = section_of((ROOT / "docs" / place.page).read_text(), place.section)
    assert documents(lines, place, key), f"docs/{place.page}, {place.section} lacks the key '{key}' of {field}"


@pytest.mark.parametrize(
    ("reader", "key"),
    [
        ("sequence_multi_object.cpp read_association", "gate_probability"),
        ("sequence_camera.cpp read_motion", "period_s"),
        ("simulation_config.cpp get_component", "offset"),
    ],
)
def test_a_key_of_another_table_does_not_count(reader: str, key: str) -> None:
    """These keys have a namesake in another table, which has its own reader."""
    assert reads(functions(reader).replace(f'"{key}"', ""), key) is False
    others = [p.name for p in CONFIG.glob("*.cpp") if reads(p.read_text(), key)]
    assert others and reads(functions(reader), key)


@pytest.mark.parametrize(("place", "key"), [(NOISE, "offset"), (MODEL, "class"), (ASSOCIATION, "gate_probability")])
def test_a_row_that_is_gone_is_noticed(place: Place, key: str) -> None:
    lines = section_of((ROOT / "docs" / place.page).read_text(), place.section)
    kept = [line for line in lines if line not in cells_with(lines, key)]
    assert documents(lines, place, key) and not documents(kept, place, key)


@pytest.mark.parametrize(("reader", "section"), [("read_node", "`[live]`"), ("read_source", "`[[sources]]`")])
def test_every_key_of_posemix_live_is_documented(reader: str, section: str) -> None:
    called = r'(?:get_\w+(?:<\w+>)?\(|count_or\(\*table, |noise_of\(table, noise_models, )"(\w+)"'
    keys = {"name", *re.findall(called, functions(f"../live/settings.cpp {reader}"))}
    lines = section_of((ROOT / "docs" / "live.md").read_text(), section)
    rows = [line.split("|")[1] for line in lines if line.startswith("| `")]
    assert keys == {key for row in rows for key in re.findall(r"`([^`]+)`", row)}


def test_exceptions_of_files_are_of_fields_that_exist() -> None:
    fields = {f"{name}.{field}" for name in IN_FILES for field in STRUCTS[name]}
    assert set(NOT_IN_FILES) <= fields
    assert {f"{name}.{field}" for name, (_, keys) in IN_FILES.items() for field in keys} <= fields


def test_all_settings_have_a_file_or_a_reason() -> None:
    settings = {name for name in STRUCTS if name.endswith(("Settings", "Config")) or name.startswith("Simulation")}
    of_simulation = {"SimulationFile"}  # the content of the file itself
    assert settings - of_simulation - IN_FILES.keys() - WITHOUT_FILE.keys() == set()
    assert WITHOUT_FILE.keys() <= STRUCTS.keys() and not WITHOUT_FILE.keys() & IN_FILES.keys()


def test_sources_of_settings_are_where_the_places_say() -> None:
    assert all(Path(CONFIG / place.reader.split()[0]).is_file() for _, _, place in places())
