# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Names and signatures of the public part of a Python package, one line each."""

import enum
import importlib
import inspect
import pkgutil
import re


# What these packages name themselves is public, not their modules.
WHOLE = ("posemix.bags", "posemix.live_view", "posemix.ros")


def public_modules(name):
    """The package and its modules, but for private ones and those that need a package that is not there."""
    package = importlib.import_module(name)
    yield package
    for found in pkgutil.walk_packages(package.__path__, f"{name}."):
        if any(part.startswith("_") for part in found.name.split(".")):
            continue
        if found.name.rpartition(".")[0] in WHOLE:
            continue
        try:
            yield importlib.import_module(found.name)
        except ModuleNotFoundError:  # rclpy, of which there is no package on PyPI
            continue


def signatures(function):
    """Of a compiled function all overloads, as nanobind states them; of one in Python what inspect says."""
    compiled = getattr(function, "__nb_signature__", None)
    if compiled:
        texts = [re.sub(r"\\\d+", "...", overload[0]) for overload in compiled]  # values of defaults stand elsewhere
        return [" ".join(text.split()).removeprefix("def ").split("(", 1)[1] for text in texts]
    try:
        return [str(inspect.signature(function)).removeprefix("(")]
    except (TypeError, ValueError):
        return ["...)"]


def member_lines(path, member):
    if isinstance(member, (staticmethod, classmethod)):
        member = member.__func__
    if isinstance(member, property):
        result = signatures(member.fget)[0].rpartition("->")[2].strip() if member.fget else ""
        writable = " (may be assigned)" if member.fset else ""
        yield f"{path}: {result}{writable}"
    elif inspect.isroutine(member) or hasattr(member, "__nb_signature__"):
        for signature in signatures(member):
            if signature == "self, /, *args, **kwargs)":  # of every class that only the library makes
                continue
            yield f"{path}({signature}"
    else:
        yield path


def class_lines(path, found):
    bases = [base.__name__ for base in found.__bases__ if base is not object]
    yield f"class {path}({', '.join(bases)})"
    if issubclass(found, enum.Enum):
        yield from (f"{path}.{name}" for name in found.__members__)
        return
    members = {}
    for parent in reversed(found.__mro__):
        if parent.__module__.startswith("posemix"):
            members.update(vars(parent))
    # Fields of dataclasses have no attribute of the class without a default.
    for name in {**dict.fromkeys(getattr(found, "__dataclass_fields__", {})), **members}:
        if name == "__init__" or not name.startswith("_"):
            yield from member_lines(f"{path}.{name}", members.get(name))


def object_lines(path, found):
    if inspect.isclass(found):
        yield from class_lines(path, found)
    else:
        yield from member_lines(path, found)


def is_public(module, name, found):
    if name.startswith("_") or inspect.ismodule(found):
        return False
    if hasattr(module, "__all__"):
        return name in module.__all__
    origin = getattr(found, "__module__", None)
    return isinstance(origin, str) and origin.startswith("posemix")


def public_names(name):
    """Every object under the shortest of its public names."""
    seen = set()
    for module in sorted(public_modules(name), key=lambda module: (module.__name__.count("."), module.__name__)):
        yield f"module {module.__name__}"
        for attribute in sorted(vars(module)):
            found = vars(module)[attribute]
            if not is_public(module, attribute, found) or id(found) in seen:
                continue
            seen.add(id(found))
            yield from object_lines(f"{module.__name__}.{attribute}", found)
