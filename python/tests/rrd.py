# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Reads recordings of Rerun back."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path
from typing import Any

import pytest

rr = pytest.importorskip("rerun")


def columns(path: Path) -> dict[str, dict[str, list[Any]]]:
    """Columns by entity and name, rows in the order of time; times in nanoseconds."""
    module = pytest.importorskip("rerun.chunk" if hasattr(rr, "chunk") else "rerun.experimental")
    found: dict[str, dict[str, list[Any]]] = defaultdict(lambda: defaultdict(list))
    for chunk in module.RrdReader(str(path)).stream().to_chunks():
        batch = chunk.to_record_batch()
        for name, column in zip(batch.schema.names, batch.columns, strict=True):
            if str(column.type).startswith(("timestamp", "duration")):
                column = column.cast("int64")
            found[chunk.entity_path.lstrip("/")][name] += column.to_pylist()
    return found
