# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Copies of settings and dicts that cannot be assigned to, where an assignment would change nothing but the copy."""

from __future__ import annotations

import functools
from typing import Any, NoReturn, TypeVar

K = TypeVar("K")
V = TypeVar("V")


class FrozenDict(dict[K, V]):
    """A dict that cannot be changed, where a change would be made to a copy alone."""

    def _refuse(self, *values: Any, **named: Any) -> NoReturn:
        raise TypeError("this dict is a copy that cannot be changed; expected another object, as by replace()")

    __setitem__ = __delitem__ = __ior__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> tuple[Any, ...]:
        return FrozenDict, (dict(self),)


def _blank(cls: Any) -> Any:
    return cls.__new__(cls)


@functools.cache
def frozen_class(cls: type) -> type:
    """The class of frozen copies of objects of `cls`; `cls` itself if its attributes cannot be assigned at all."""
    if not any(isinstance(value, property) and value.fset for value in vars(cls).values()):
        return cls

    def refuse(self: Any, name: str, value: Any = None) -> NoReturn:
        raise AttributeError(
            f"{cls.__name__}.{name} cannot be assigned here: this {cls.__name__} is a copy, and nothing else would"
            f" change. copy.copy() gives one that can be changed and assigned as a whole."
        )

    def reduced(self: Any, protocol: int) -> tuple[Any, ...]:
        return _blank, (cls,), self.__getstate__()

    members = {
        "__slots__": (), "__module__": cls.__module__, "__qualname__": cls.__qualname__, "__doc__": cls.__doc__,
        "__hash__": None, "__setattr__": refuse, "__delattr__": refuse, "__reduce_ex__": reduced, "_is_frozen": True,
    }  # fmt: skip
    return type(cls.__name__, (cls,), members)
