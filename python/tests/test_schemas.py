# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The JSON Schemas in docs/schemas hold for what is written, and refuse what the readers refuse."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import posemix as px
import pytest
from jsonschema import Draft202012Validator
from test_compatibility import SAMPLES, run

SCHEMAS = Path(__file__).resolve().parents[2] / "docs/schemas"
VALIDATORS = {
    path.name.removesuffix(".schema.json"): Draft202012Validator(json.loads(path.read_text()))
    for path in sorted(SCHEMAS.glob("*.schema.json"))
}
FILES = {"mixture": ["*/mixture_*.json", "*.json"], "observation": ["*/observations.jsonl"]}


def documents(folder: Path, schema: str) -> Iterator[tuple[Path, Any]]:
    for pattern in FILES.get(schema, [f"*/{schema}.json"]):
        for path in sorted(folder.glob(pattern)):
            texts = path.read_text().splitlines() if path.suffix == ".jsonl" else [path.read_text()]
            yield from ((path, json.loads(text)) for text in texts)


def complaints(schema: str, document: Any) -> list[str]:
    return [f"{error.json_path}: {error.message}" for error in VALIDATORS[schema].iter_errors(document)]


@pytest.mark.parametrize("schema", VALIDATORS)
def test_a_schema_is_one(schema: str) -> None:
    Draft202012Validator.check_schema(VALIDATORS[schema].schema)


@pytest.mark.parametrize("schema", VALIDATORS)
def test_what_earlier_versions_wrote_fits(schema: str) -> None:
    found = [(path, complaints(schema, document)) for path, document in documents(SAMPLES, f"*/{schema}")]
    for folder in SAMPLES.iterdir():
        found += [(path, complaints(schema, document)) for path, document in documents(folder, schema)]
    assert found
    assert [(path, texts) for path, texts in found if texts] == []


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the program writes of a scene in which objects move, and of the kept one with other filters."""
    folder = tmp_path_factory.mktemp("written")
    root = SAMPLES.parent.parent
    moving = [root / "configs/hand-held.toml", "--seed", "1", "--set", "camera.frames=40"]
    run("simulate", *moving, "--out", folder / "moving", "--quiet")
    run("slam", folder / "moving/sequence.toml", "--out", folder / "moving-run", "--quiet")
    kept = SAMPLES / "0.2/sequence/sequence.toml"
    for method in ("gm-iekf", "riekf", "rbpf", "max_mixture", "multi_object"):
        run("slam", kept, "--set", f"filter.method={method!r}", "--out", folder / method, "--quiet")
    run("slam", kept, "--smooth", "--out", folder / "smoothed", "--quiet")
    run("consistency", folder / "multi_object", "--out", folder / "consistency", "--quiet")
    run("convert", kept, "--out", folder / "observed", "--quiet")
    mixture = folder / "multi_object/mixture_tea-box.json"
    run("convert", mixture, "--distribution", "projected", "--out", folder / "projected.json", "--quiet")
    return folder


@pytest.mark.parametrize("schema", VALIDATORS)
def test_what_is_written_fits(schema: str, written: Path) -> None:
    found = [(path, complaints(schema, document)) for path, document in documents(written, schema)]
    assert found
    assert [(path, texts) for path, texts in found if texts] == []


def changes(value: Any, place: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], Any]]:
    """Every place of a document, with other values for it; None stands for a key that is left out."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield (*place, key), None
            yield from changes(item, (*place, key))
        yield (*place, "no-such-key"), 1
    elif isinstance(value, list):
        yield place, value[:-1]
        yield place, [*value, value[-1]] if place[-1] != "components" else "none"
        yield from changes(value[-1], (*place, len(value) - 1))
    else:
        yield from ((place, other) for other in ("a word", [1], {}, True, -7.5) if other != value)


def changed(document: Any, place: tuple[Any, ...], value: Any) -> Any:
    result = copy.deepcopy(document)
    target = result
    for key in place[:-1]:
        target = target[key]
    if value is None:
        del target[place[-1]]
    else:
        target[place[-1]] = value
    return result


READERS: dict[str, tuple[Callable[[Path], Any], str]] = {
    "mixture": (px.read_mixture, "mixture.json"),
    "posterior": (px.read_posterior, "posterior.json"),
    "observation": (px.read_observations, "observations.jsonl"),
}
# What a schema cannot say: unit quaternions, covariances that are positive definite, sizes that fit each other.
BEYOND = ("norm ", "positive definite", "entries, expected", "SE(3)^", "again")


@pytest.mark.parametrize("schema", READERS)
def test_a_reader_refuses_what_the_schema_refuses_and_the_other_way_round(schema: str, tmp_path: Path) -> None:
    read, name = READERS[schema]
    tried, apart = 0, []
    for path, document in list(documents(SAMPLES / "0.2", schema))[:4]:
        for place, value in changes(document):
            other = changed(document, place, value)
            (tmp_path / name).write_text(json.dumps(other) + "\n")
            told = complaints(schema, other)
            try:
                read(tmp_path / name)
            except ValueError as error:
                if not told and not any(word in str(error) for word in BEYOND):
                    apart.append((path.name, place, value, str(error)))
            else:
                if told:
                    apart.append((path.name, place, value, told[0]))
            tried += 1
    assert apart == []
    assert tried > 50
