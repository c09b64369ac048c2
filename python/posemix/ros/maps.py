# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Maps in files, and old maps in the world of a run that goes on."""

from __future__ import annotations

import copy
import hashlib
import json
import math
import os
import secrets
import stat
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from posemix._core import (
    ObjectModel,
    ObjectPrior,
    Relocalisation,
    StampedSlam,
    StaticMotion,
    SymmetryGroup,
    models_with_priors,
)
from posemix._files import write_text
from posemix.density import ConcentratedGaussian
from posemix.lie import SE3

__all__ = ["SavedMap", "carried_over", "merged", "read_map", "write_map"]

_FORMAT = "posemix.ros map"
# How the files begin.
_STATE, _NOTE = b"\x89PMXSTATE\r\n", f'{{"format": "{_FORMAT}"'.encode()
# Of priors, none of which is certain.
_LEAST_PROBABILITY, _LARGEST_PROBABILITY = 0.05, 0.99
_LEAST_EXISTENCE = 0.5
# Hypotheses of one place whose rotations differ by less, up to the symmetries, are one [rad].
_SAME_ROTATION = 0.5


@dataclass(frozen=True)
class SavedMap:
    """A map as it was saved.

    Attributes
    ----------
    slam : StampedSlam
        The whole state.
    start_ns : int or None
        Time of the stamp 0 [ns]; None where the file does not say, as of a map that another program has saved.
    body : str
        Frame of the body.
    lineage : frozenset of str
        The runs whose images are in it.
    since_s : float
        Stamp of its first estimate [s]; what is older does not count.
    several, symmetries : frozenset of str
        Classes of several objects, and those whose symmetries were known.
    odometry : tuple of int and SE3, or None
        The newest stamp [ns] with its pose of the odometry.
    """

    slam: StampedSlam
    start_ns: int | None
    body: str
    lineage: frozenset[str] = frozenset()
    since_s: float = -math.inf
    several: frozenset[str] = frozenset()
    symmetries: frozenset[str] = frozenset()
    odometry: tuple[int, SE3 | None] | None = None

    @property
    def objects(self) -> int:
        """Number of objects that were seen."""
        last = self.slam.finish()
        return 0 if last is None else sum(world is not None for world in last.estimate.objects.values())


def _note(path: Path) -> Path:
    return path.with_name(path.name + ".json")


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _check_writable(place: Path) -> None:
    """A parameter that names another file must not cost its content."""
    for file, begins in ((place, _STATE), (_note(place), _NOTE)):
        if not file.exists():
            continue
        with file.open("rb") as there:
            if there.read(len(begins)) != begins:
                raise ValueError(f"{file}: is there and no map, so that it is not written over")


def write_map(path: str, found: SavedMap) -> str:
    """Saves the state in a file, and what of the node belongs to it in PATH.json. Returns the SHA-256 of the state.

    Raises
    ------
    ValueError
        Where a file is that is no map, or the note of none.
    OSError
        When it cannot be written; a file from before is as it was.
    """
    place = Path(path).expanduser()
    _check_writable(place)
    place.parent.mkdir(parents=True, exist_ok=True)
    # A link stays one, and a file has the permissions that it had, before anything is in it.
    target = Path(os.path.realpath(place))
    state = target.with_name(f".{target.name}.{secrets.token_hex(8)}")
    try:
        if target.exists():
            state.touch(mode=0o600)
            state.chmod(stat.S_IMODE(target.stat().st_mode))
        found.slam.save(state)
        note = _note_of(found, _digest(state))
        # Whichever of the two states is there after a kill, its note is there, too.
        if before := _note_beside(place):
            before.pop("before", None)
            note["before"] = before
        write_text(_note(place), json.dumps(note) + "\n")
        _sync(_note(place))
        state.replace(target)
        _sync(target.parent)
    finally:
        state.unlink(missing_ok=True)
    return str(note["state_sha256"])


def _sync(path: Path) -> None:
    """Waits until a file, or the names in a folder, are on the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _note_of(found: SavedMap, digest: str) -> dict[str, Any]:
    note: dict[str, Any] = {"format": _FORMAT, "version": 1, "state_sha256": digest}
    note |= {"start_ns": found.start_ns, "body": found.body, "lineage": sorted(found.lineage)}
    note |= {"several": sorted(found.several), "symmetries": sorted(found.symmetries)}
    if math.isfinite(found.since_s):
        note["since_s"] = found.since_s
    if found.odometry is not None:
        stamp_ns, pose = found.odometry
        note["odometry"] = [stamp_ns, None if pose is None else pose.to_tq().tolist()]
    return note


def _note_beside(place: Path) -> dict[str, Any] | None:
    """The note of the state that is in a file; none where there is no state, or the notes are of others."""
    try:
        note = json.loads(_note(place).read_text(encoding="utf-8"))
        digest = _digest(place)
        for one in (note, note.get("before", {})):
            if one.get("version") == 1 and one.get("state_sha256") == digest:
                return dict(one)
    except (OSError, ValueError, AttributeError, RecursionError):
        pass
    return None


def read_map(path: str) -> SavedMap:
    """Loads a state, with what is beside it where that is of this state.

    Raises
    ------
    ValueError
        For a file that is no state.
    OSError
        When it cannot be read.
    """
    place = Path(path).expanduser()
    if not place.exists():
        raise FileNotFoundError(f"{place}: there is no such map")
    slam = StampedSlam.load(place)
    try:
        if note := _note_beside(place):
            stamp_ns, numbers = note.get("odometry", (None, None))
            return SavedMap(
                slam, int(note["start_ns"]), str(note["body"]), lineage=frozenset(note["lineage"]),
                since_s=float(note.get("since_s", -math.inf)), several=frozenset(note["several"]),
                symmetries=frozenset(note["symmetries"]),
                odometry=None if stamp_ns is None else (int(stamp_ns), None if not numbers else SE3.from_tq(numbers)),
            )  # fmt: skip
    except (ValueError, KeyError, TypeError):
        pass
    # Without a note a map stands for itself.
    return SavedMap(slam, None, "", lineage=frozenset([_digest(place)]))


def _total(slam: StampedSlam, name: str, mean: SE3, symmetries: SymmetryGroup) -> float:
    """Probability of all hypotheses that are, up to the symmetries, the pose."""
    found = 0.0
    for hypothesis in slam.hypotheses(name):
        difference = (symmetries.closest(hypothesis.pose, mean, np.eye(6)) * mean.inverse()).log()
        if float((difference[:3] ** 2).sum()) < _SAME_ROTATION**2:
            found += hypothesis.probability
    return found


def carried_over(slam: StampedSlam, models: Mapping[str, ObjectModel]) -> dict[str, ObjectPrior]:
    """Where the objects of a run are that stand still, as priors by id, up to the symmetries of these models."""
    now = slam.estimate()
    if now is None:
        return {}
    found = {}
    for name, world in now.estimate.objects.items():
        existence = now.estimate.existences[name]
        if world is None or name not in models or (existence is not None and existence < _LEAST_EXISTENCE):
            continue
        if _moves(models[name]):
            continue
        found[name] = _prior(world, _total(slam, name, world.mean, models[name].symmetries))
    return found


def _prior(world: ConcentratedGaussian[SE3], probability: float) -> ObjectPrior:
    # The setting takes the compiled part of a density.
    compiled: Any = world._handle
    return ObjectPrior(world=compiled, probability=min(max(probability, _LEAST_PROBABILITY), _LARGEST_PROBABILITY))


def _moves(model: ObjectModel) -> bool:
    return any(not isinstance(motion, StaticMotion) for motion in model.motion.models)


def with_priors(models: Sequence[ObjectModel], priors: Mapping[str, ObjectPrior]) -> list[ObjectModel]:
    """The models with the priors that there are."""
    found = []
    for model in models:
        one = copy.copy(model)
        one.prior = priors.get(model.id)
        found.append(one)
    return found


def merged(
    old: StampedSlam, now: StampedSlam, relocalisation: Relocalisation, models: Sequence[ObjectModel]
) -> list[ObjectModel]:
    """Models for a run that goes on in the world of `now` and knows the old map.

    Objects that are in both have their names of old; one of the new run whose name another has in the old map gets the
    next free one of its class.

    Parameters
    ----------
    old, now : StampedSlam
        The old map and the run.
    relocalisation : Relocalisation
        How they belong together.
    models : sequence of ObjectModel
        Models of all objects of both.
    """
    priors = {m.id: m.prior for m in models_with_priors(old, relocalisation) if m.prior is not None}
    by_id = {model.id: model for model in models}
    agreed = {pair.new_object for pair in relocalisation.agreed}
    more: list[ObjectModel] = []
    for name, prior in carried_over(now, by_id).items():
        if name in agreed:
            continue
        place = name
        if name in priors:
            of_class = [m.id for m in models if m.class_id and m.class_id == by_id[name].class_id]
            place = next((other for other in of_class if other not in priors), "")
            if not place:
                place = _free(name, by_id)
                by_id[place] = model = copy.copy(by_id[name])
                model.id = place
                more.append(model)
        priors[place] = prior
    return with_priors([*models, *more], priors)


def _free(name: str, taken: Mapping[str, ObjectModel]) -> str:
    number = 2
    while f"{name}_{number}" in taken:
        number += 1
    return f"{name}_{number}"
