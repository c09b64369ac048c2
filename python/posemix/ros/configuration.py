# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""What the node's parameters say: detectors, models of objects, settings."""

from __future__ import annotations

import copy
import math
import re
import tempfile
import warnings
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast


from posemix._core import (
    ConstantVelocityMotion,
    DetectorNoise,
    GivenCovariance,
    MotionModel,
    MotionModels,
    MotionSettings,
    MultiObjectSlamSettings,
    ObjectModel,
    ObjectSlamSettings,
    PutDownMotion,
    RandomWalkMotion,
    StampedSlamSettings,
    SymmetryGroup,
    calm_and_agile,
    default_detector_noise,
    read_bop_models,
    read_slam_job,
)
from posemix.bags.rows import PoseOf
from posemix.ros.parameters import CLASS, NODE, SOURCE, Parameter, settings_of, settings_parameters

__all__ = ["Configuration", "Source", "class_parameters", "configuration", "names", "source_parameters"]

_DUMMY = '{"stamp_s":0,"id":"object","components":[{"weight":1,"pose":[0,0,1,0,0,0,1]}]}\n'
_MOTIONS = {"put_down": PutDownMotion, "random_walk": RandomWalkMotion, "constant_velocity": ConstantVelocityMotion}


@dataclass(frozen=True)
class Source:
    """A detector.

    Attributes
    ----------
    name : str
        Its name, which observations have; "" for the first one.
    topic, type : str
        Topic, and type of its messages.
    frame : str
        Frame of the camera in place of that in the messages.
    pose : {"result", "bbox"}
        The pose of a detection.
    least_score : float
        Detections with a smaller score are left out.
    noise : DetectorNoise
        The error of its detections.
    """

    name: str
    topic: str
    type: str
    frame: str
    pose: PoseOf
    least_score: float
    noise: DetectorNoise


@dataclass(frozen=True)
class Configuration:
    """All that the node does by.

    Attributes
    ----------
    values : mapping
        The values of all parameters.
    sources : list of Source
        The detectors.
    tracker, motion, stamped
        Settings of `StampedSlam`; those of the tracker have the model of objects on sight.
    """

    values: Mapping[str, Any]
    sources: list[Source]
    tracker: MultiObjectSlamSettings
    motion: MotionSettings
    stamped: StampedSlamSettings
    symmetries: Mapping[str, SymmetryGroup] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Any:
        return self.values[name]

    @property
    def cameras(self) -> list[str]:
        """Frames of the cameras of a rig; empty where there is one camera."""
        return [name.lstrip("/") for name in names(self.values["cameras"])]

    @property
    def declared(self) -> list[str]:
        """Classes with parameters of their own."""
        return names(self.values["classes"])

    @property
    def has_odometry(self) -> bool:
        """Whether the motion model takes poses of odometry."""
        return self.motion.model in (MotionModel.odometry, MotionModel.given)

    def models(
        self, symmetries: Mapping[str, SymmetryGroup], several: Collection[str] = ()
    ) -> list[ObjectModel]:
        """The models of the classes that are declared, and of those that are `several` or with known symmetries."""
        declared = self.declared
        others = {*symmetries, *several} - set(declared) if self.values["on_sight"] else set()
        found = []
        for name in declared:
            count = int(self.values[f"{name}.instances"])
            ids = [name] if count == 1 else [f"{name}_{i + 1}" for i in range(count)]
            found += self._instances(name, ids, self.values[f"{name}.motion"], symmetries)
        for name in sorted(others):
            # The first has the name that it had while it was alone.
            count = int(self.values["on_sight_instances"]) if name in several else 1
            ids = [name] + [f"{name}_{i}" for i in range(2, count + 1)]
            found += self._instances(name, ids, "static", symmetries)
        return found

    def _instances(
        self, name: str, ids: Sequence[str], motion: str, symmetries: Mapping[str, SymmetryGroup]
    ) -> list[ObjectModel]:
        of_class = name if len(ids) > 1 else ""
        return [self.model(own, of_class, motion, symmetries.get(name)) for own in ids]

    def model(
        self, name: str, class_id: str = "", motion: str = "static", symmetries: SymmetryGroup | None = None
    ) -> ObjectModel:
        """A model of an object with the noise of all detectors."""
        others = {source.name: source.noise for source in self.sources if source.name}
        return ObjectModel(
            id=name, class_id=class_id, noise=self.sources[0].noise, detectors=others,
            symmetries=symmetries or SymmetryGroup(), motion=_motion(motion),
        )  # fmt: skip


def names(values: Sequence[str]) -> list[str]:
    """The names of an array in which an empty one stands for none."""
    return [value for value in values if value]


def source_parameters(values: Mapping[str, Any]) -> list[Parameter]:
    """The parameters of the sources that there are."""
    return _of_each(names(values["sources"]), SOURCE)


def class_parameters(values: Mapping[str, Any]) -> list[Parameter]:
    """The parameters of the classes that are declared."""
    return _of_each(names(values["classes"]), CLASS)


def _of_each(owners: Sequence[str], each: Sequence[Parameter]) -> list[Parameter]:
    return [
        Parameter(f"{owner}.{p.name}", p.default, p.text, p.choices) for owner in owners for p in each
    ]


def configuration(given: Mapping[str, Any]) -> Configuration:
    """What parameters say; those that are not given have their defaults.

    Raises
    ------
    ValueError
        Naming the parameter that is not valid, or is not known.
    OSError
        For a file that cannot be read.
    """
    known = [*NODE, *settings_parameters()]
    values: dict[str, Any] = {p.name: given.get(p.name, p.default) for p in known}
    more = [*source_parameters(values), *class_parameters(values)]
    values.update({p.name: given.get(p.name, p.default) for p in more})
    unknown = sorted(set(given) - set(values))
    if unknown:
        raise ValueError(f"there is no parameter '{unknown[0]}'")
    for parameter in (*known, *more):
        parameter.checked(values[parameter.name])
    _require_sound(values)
    for name in ("world_frame", "odom_frame", "camera_frame", "body_frame"):
        values[name] = values[name].lstrip("/")
    noises = _noises(values["noise_file"], values)
    sources = [_source(values, name, i, noises) for i, name in enumerate(names(values["sources"]))]
    defaults = ObjectSlamSettings()
    tracker = settings_of(cast(MultiObjectSlamSettings, defaults.tracker), values, "")
    motion = settings_of(defaults.motion, values, "motion.")
    stamped = settings_of(StampedSlamSettings(), values, "stamped.")
    made = Configuration(values, sources, tracker, motion, stamped, _bop_symmetries(values))
    if values["on_sight"]:
        tracker.on_sight = made.model("on_sight")
    return made


def _require_sound(values: Mapping[str, Any]) -> None:
    for name, value in values.items():
        # Of this one infinity has a meaning.
        is_known = value == math.inf and name.endswith(".noise_scale_detections")
        if isinstance(value, float) and not math.isfinite(value) and not is_known:
            raise ValueError(f"{name} is {value}; expected a finite number")
    cameras = [name.lstrip("/") for name in names(values["cameras"])]
    if len(set(cameras)) < len(cameras):
        raise ValueError(f"cameras is {cameras}; expected every frame once")
    owners = names(values["sources"])
    if not owners or len(set(owners)) < len(owners):
        raise ValueError(f"sources is {owners}; expected at least one name, and every name once")
    for name in names(values["classes"]):
        if values[f"{name}.instances"] < 1:
            raise ValueError(f"{name}.instances is {values[f'{name}.instances']}; expected at least 1")
    for name in ("queue_size", "replay_images", "input_depth", "on_sight_instances"):
        if values[name] < 1:
            raise ValueError(f"{name} is {values[name]}; expected at least 1")
    if values["report_frames"] < 2:
        raise ValueError(f"report_frames is {values['report_frames']}; expected at least 2")
    for name in ("max_gap_s", "transform_timeout_s", "diagnostics_hz", "markers_sigmas", "view_hz"):
        if not values[name] > 0:
            raise ValueError(f"{name} is {values[name]}; expected a positive number")


def _source(
    values: Mapping[str, Any], name: str, index: int, noises: Mapping[str, DetectorNoise]
) -> Source:
    of = {p.name: values[f"{name}.{p.name}"] for p in SOURCE}
    if of["pose"] == "bbox" and of["type"] == "Detection2DArray":
        raise ValueError(f"{name}.pose is 'bbox', of which a Detection2DArray has none in space; expected 'result'")
    return Source(
        name if index else "", of["topic"] or f"~/{name}", of["type"], of["frame"].lstrip("/"), of["pose"],
        of["least_score"], noises[name],
    )  # fmt: skip


def _noises(path: str, values: Mapping[str, Any]) -> dict[str, DetectorNoise]:
    return {name: _noise(path, values, name) for name in names(values["sources"])}


def _noise(path: str, values: Mapping[str, Any], source: str) -> DetectorNoise:
    of = {p.name: values[f"{source}.{p.name}"] for p in SOURCE}
    if of["noise"]:
        if not path:
            raise ValueError(f"{source}.noise is '{of['noise']}' without a noise_file; expected the file that has it")
        noise = noise_of_toml(Path(path).read_text(encoding="utf-8"), of["noise"], path)
    elif of["rotation_sd_deg"] == 0 and of["translation_sd_m"] == 0:
        noise = default_detector_noise()
    else:
        text = (
            f"[noise.given]\ncomponents = [{{rotation_sd_deg = {float(of['rotation_sd_deg'])!r}, "
            f"translation_sd_m = {float(of['translation_sd_m'])!r}}}]\n"
            f"clutter = {{weight = {float(of['clutter'])!r}}}\n"
        )
        noise = noise_of_toml(text, "given", f"the noise of source '{source}'")
    if of["given_covariance"]:
        dependence = copy.copy(noise.dependence)
        dependence.given_covariance = GivenCovariance[of["given_covariance"]]
        noise = DetectorNoise(list(noise.components), noise.clutter, dependence)
    return noise


def noise_of_toml(text: str, name: str, where: str) -> DetectorNoise:
    """The noise [noise.NAME] of a text, as in sequence files; raises ValueError naming the place and the cause."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        (place / "observations.jsonl").write_text(_DUMMY)
        rest = f'\n[[objects]]\nid = "object"\nnoise = "{name}"\n[[observations]]\njsonl = "observations.jsonl"\n'
        (place / "noise.toml").write_text(text + rest)
        try:
            # What is assumed, where the text says nothing, is what the sequence files' documentation says.
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                job = read_slam_job(place / "noise.toml", place, ["schema=1"])
        except ValueError as error:
            raise ValueError(f"{where}: {str(error).replace(str(place / 'noise.toml'), 'line')}") from None
        return job.models[0].noise


def _motion(word: str) -> MotionModels:
    if word == "static":
        return MotionModels()
    if word == "calm_and_agile":
        return calm_and_agile()
    return MotionModels(models=[_MOTIONS[word]()])


def _bop_symmetries(values: Mapping[str, Any]) -> dict[str, SymmetryGroup]:
    """Symmetries of the declared classes, each of which has an entry."""
    if not values["models_info"]:
        return {}
    if not names(values["classes"]):
        raise ValueError("models_info is for what is in classes, which is empty; expected the classes to be detected")
    entries = read_bop_models(values["models_info"])
    found = {}
    for name in names(values["classes"]):
        digits = re.search(r"\d+$", name)
        number = int(values[f"{name}.bop_id"]) or int(digits[0] if digits else 0)
        if number not in entries:
            there = ", ".join(str(key) for key in sorted(entries))
            raise ValueError(
                f"{values['models_info']}: no entry {number} for class '{name}'; expected {name}.bop_id of {there}"
            )
        found[name] = entries[number].symmetries
    return found
