# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Arguments that nobody should give, and what becomes of the calls."""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import posemix as px
from public_calls import LISTING, NAN, Callee, good, instances, OWNERS, resolve, working

def with_number(value: Any, number: float) -> Any:
    array = np.array(value, dtype=float)
    array.flat[array.size // 2] = number
    return float(array) if array.ndim == 0 else array


def hostile(value: Any) -> Iterator[tuple[str, Any]]:
    """What somebody could give in place of a value, with a word for it."""
    yield "None", None
    yield "object()", object()
    if isinstance(value, bool):
        return
    if isinstance(value, int):
        for number in (-1, 2**62, 2**63, 2**64, -(2**63)):
            yield str(number), number
    if isinstance(value, float):
        for number in (NAN, np.inf, -np.inf, -1.0, 0.0, 1e300, -1e300, 1e-320):
            yield str(number), number
    if isinstance(value, str):
        for text in ("", "\0", "a\nb", "x" * 10000, "\ud800"):
            yield repr(text)[:12], text
    if isinstance(value, list) and value and not isinstance(value[0], float):
        yield "[]", []
        yield "[None]", [None]
        for word, one in hostile(value[0]):
            yield f"[{word}]", [one, *value[1:]]
    elif isinstance(value, np.ndarray | list):
        array = np.asarray(value, dtype=float)
        for number in (NAN, np.inf, 1e300, -1.0):
            yield f"array with {number}", with_number(array, number)
        yield "empty array", np.zeros((0, *array.shape[1:]))
        yield "row too many", np.concatenate([array, array[:1]]) if array.ndim else array
        yield "flat", np.zeros(array.size + 1)
        yield "in 5 dimensions", np.zeros((1, 1, 1, 1, 1))
        yield "strings", np.array(["a", "b"])
        yield "complex", array * 1j
    for field in FIELDS.get(type(value).__name__, []):
        yield f"{field} is nan", with_field(value, field, NAN)
    if isinstance(value, px.SE3):
        yield "matrix with nan", np.full((4, 4), NAN)
        yield "no poses", px.SE3.exp(np.zeros((0, 6)))
        yield "missing poses", px.with_misses([None, None])
        yield "far away", px.SE3(translation=[1e300, 0.0, 0.0])


def with_field(settings: Any, field: str, value: Any) -> Any:
    changed = copy.deepcopy(settings)
    setattr(changed, field, value)
    return changed


FIELDS: dict[str, list[str]] = {}
for _line in LISTING.read_text().splitlines():
    if _found := re.match(r"^posemix\.(\w+)\.(\w+): float \(may be assigned\)", _line):
        FIELDS.setdefault(_found[1], []).append(_found[2])


# --- attacks

# Large numbers are much to do here, and nothing wrong.
LONG_WORK = {("posemix.bootstrap_regions", "count")}
REFUSALS = (ValueError, TypeError, IndexError, KeyError, OverflowError, OSError, MemoryError)


def attacks(callee: Callee) -> Iterator[tuple[str, Callable[[], Any], bool]]:
    """What is called, how, and whether it must be refused; nothing where no call succeeds."""
    bound = bound_callee(callee)
    found = bound and working(callee, bound())
    if not bound or not found:
        return
    arguments = found[0]
    yield f"{callee.path} as it should be", lambda: bound()(**arguments), False
    for one in callee.parameters:
        if (callee.path, one.name) in LONG_WORK:
            continue
        values = [arguments[one.name]] if one.name in arguments else good(one.type, one.name)[:1]
        for value in values:
            for word, bad in hostile(value):
                given = {**arguments, one.name: bad}
                # Plain data is checked by who computes with it.
                data = callee.name in ("__init__", "replace")
                must = not data and bool(re.search(r"\b(nan|inf)$", word.strip("[]")))

                def call(given: dict[str, Any] = given) -> Any:
                    return bound()(**given)

                yield f"{callee.path}({one.name} = {word})", call, must


def bound_callee(callee: Callee) -> Callable[[], Any] | None:
    """Makes the callable anew, with an instance of its own where it is a method."""
    if callee.name == "__init__" or not callee.is_method:
        return lambda: resolve(callee.owner if callee.name == "__init__" else callee.path)
    made = owners(callee)
    return (lambda: getattr(owners(callee)[0], callee.name)) if made else None


def owners(callee: Callee) -> list[Any]:
    """At most one instance that has the method."""
    special = OWNERS.get(callee.path.removeprefix("posemix."))
    return [special()] if special else instances(callee.owner.rpartition(".")[2])


def judge(call: Callable[[], Any], must: bool) -> str:
    """What is wrong with what happened; empty where nothing is."""
    try:
        call()
    except REFUSALS as error:
        return "" if str(error) else "a refusal without a word"
    except BaseException as error:
        return f"{type(error).__name__}: {error}"
    return "is taken" if must else ""
