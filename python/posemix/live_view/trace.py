# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""trace.json and metrics.json of a recording; docs/formats.md describes both."""

from __future__ import annotations

import json
import statistics
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any, TypeAlias

from posemix._core import TrackHealth
from posemix._files import whole_file, write_text
from posemix.live_view.entries import HEADER

__all__ = ["FRAMES", "write_results"]

FRAMES = "frames.jsonl"

_METHOD = "multi-object"
_TRACK = ("pose", "sd", "position_covariance", "covariance")
# Of an object, what stands in frames in which it is not there.
_OTHERWISE: dict[str, Any] = {
    "status": "none", "mode_probability": None, "existence": None, "health": "none", "register_again": False,
    "alternatives": [], "detection": None,
}  # fmt: skip
_MOTION = ("models", "twist", "twist_sd")
_CONVENTIONS = {
    "pose": "[tx, ty, tz, qx, qy, qz, qw], metres and unit quaternion",
    "sd": "[rx, ry, rz, tx, ty, tz], radians and metres: square roots of the covariance diagonal of xi in "
    "X = Exp(xi) X0, in the reference frame",
    "position_covariance": "[xx, xy, xz, yy, yz, zz], square metres: of the position in the reference frame, to first "
    "order",
    "covariance": "upper triangle row by row of the covariance of xi = [rotation, translation] in X = Exp(xi) X0",
    "camera": "T_world_camera",
    "world": "T_world_object",
    "relative": "T_camera_object",
    "detection": "T_camera_object",
}
Spool: TypeAlias = tempfile.SpooledTemporaryFile[str]

# Of the frames of one object so much is in memory before it goes to a file.
_SPOOL_BYTES = 1 << 20


@dataclass
class _Pass:
    """What one pass over the frames finds: everything but the objects' frames, which go to files of their own."""

    stamps: list[float] = field(default_factory=list)
    merges: list[int] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    spools: dict[str, Spool] = field(default_factory=dict)


def _spooled(entries: Iterable[dict[str, Any]], files: ExitStack) -> _Pass:
    found = _Pass()

    def put(name: str, row: Any) -> None:
        if name not in found.spools:
            spool = tempfile.SpooledTemporaryFile(_SPOOL_BYTES, mode="w+", encoding="utf-8")
            found.spools[name] = files.enter_context(spool)
        found.spools[name].write(json.dumps([len(found.stamps), row]) + "\n")

    for entry in entries:
        put("", entry["camera"])
        for name, row in entry["objects"].items():
            put(name, row)
        found.stamps.append(entry["stamp_s"])
        found.merges.append(entry["merges"])
        found.seconds.append(entry["seconds"])
    return found


def _rows(spool: Spool, frames: int) -> list[dict[str, Any] | None]:
    """The frames of one entity, None where it is not there."""
    rows: list[dict[str, Any] | None] = [None] * frames
    spool.seek(0)
    for line in spool:
        k, row = json.loads(line)
        rows[k] = row
    return rows


def _track(rows: Sequence[Mapping[str, Any] | None]) -> dict[str, Any]:
    found: dict[str, Any] = {key: [None if row is None else row[key] for row in rows] for key in _TRACK}
    return found | {"truth": None}


def _object(rows: Sequence[Mapping[str, Any] | None], names: Sequence[str]) -> dict[str, Any]:
    found: dict[str, Any] = {
        place: _track([None if row is None else row[place] for row in rows]) for place in ("world", "relative")
    }
    for key, otherwise in _OTHERWISE.items():
        found[key] = [otherwise if row is None else row.get(key, otherwise) for row in rows]
    if any(row is not None and "nis" in row for row in rows):
        found["nis"] = [None if row is None else row.get("nis") for row in rows]
    if any(row is not None and "models" in row for row in rows):
        for key in _MOTION:
            found[key] = [None if row is None else row.get(key) for row in rows]
        count = max(len(models) for models in found["models"] if models is not None)
        found["model_names"] = list(names) or [str(i) for i in range(count)]
    return found


def _object_metrics(of_object: Mapping[str, Any]) -> dict[str, Any]:
    counts = Counter(of_object["health"])
    frames = len(of_object["health"])
    return {
        "detections": frames - of_object["status"].count("none"),
        "mode_probability": of_object["mode_probability"][-1],
        "existence": of_object["existence"][-1],
        "health": of_object["health"][-1],
        "health_shares": {health.name: counts[health.name] / frames for health in TrackHealth},
    }


def _parts(found: _Pass, name: str, model_names: Mapping[str, Sequence[str]], metrics: dict[str, Any]) -> Iterator[str]:
    """The text of trace.json in pieces, and the metrics of the objects; one object is in memory at a time."""
    n = len(found.stamps)
    order = [entity for entity in found.spools if entity]
    head = {
        "schema": 1, "type": "posemix.trace", "name": name, "method": _METHOD, "conventions": _CONVENTIONS, "frames": n,
        "stamps_s": found.stamps, "order": order, "merges": found.merges, "hypotheses": [[]] * n,
        "camera": _track(_rows(found.spools[""], n)),
    }  # fmt: skip
    yield _json(head)[:-1] + ',"objects":{'
    for i, entity in enumerate(order):
        of_object = _object(_rows(found.spools[entity], n), model_names.get(entity, ()))
        metrics[entity] = _object_metrics(of_object)
        yield ("," if i else "") + _json(entity) + ":" + _json(of_object)
    yield "}}\n"


def _json(value: Any) -> str:
    return json.dumps(value, separators=(",", ":"), allow_nan=False)


def _write_trace(
    target: Path, entries: Iterable[dict[str, Any]], name: str, model_names: Mapping[str, Sequence[str]]
) -> dict[str, Any]:
    """Writes trace.json, as a whole or not at all, and returns what metrics.json has."""
    objects: dict[str, Any] = {}
    with whole_file(target) as out, ExitStack() as files:
        found = _spooled(entries, files)
        if not found.stamps:
            raise ValueError(f"{target.parent}: there is no frame to report so far")
        for part in _parts(found, name, model_names, objects):
            out.write(part)
    return {
        "schema": 1, "frames": len(found.stamps), "method": _METHOD, "objects": objects,
        "timing": {
            "frame_median_us": 1e6 * statistics.median(found.seconds[1:] or found.seconds),
            "merges_per_frame": statistics.fmean(found.merges),
        },
    }  # fmt: skip


def _entries(file: Iterable[str], count: int, more: Iterable[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    for line in islice(file, count):
        try:
            yield json.loads(line)
        except ValueError:  # of a program that was cut off
            break
    yield from more


def write_results(folder: Path, file: Iterator[str], count: int, more: Iterable[dict[str, Any]] = ()) -> None:
    """Writes trace.json and metrics.json of so many frames of a recording, and of `more`, into a folder.

    Raises
    ------
    ValueError
        If the file is no recording.
    """
    try:
        header = json.loads(next(file, "null"))
        is_known = {key: header[key] for key in HEADER} == HEADER
    except (ValueError, TypeError, KeyError):
        is_known = False
    if not is_known:
        raise ValueError(f"{folder / FRAMES}: is no recording of a live run that this version reads")
    entries = _entries(file, count, more)
    metrics = _write_trace(folder / "trace.json", entries, header["name"], header["model_names"])
    write_text(folder / "metrics.json", json.dumps(metrics, indent=2) + "\n")
