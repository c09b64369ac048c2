# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Calls of everything public that succeed, by the listing of the API."""

from __future__ import annotations

import dataclasses
import enum
import importlib
import inspect
import itertools
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import posemix as px

ROOT = Path(__file__).resolve().parents[2]
LISTING = ROOT / "docs/api/python.txt"
CALL = re.compile(r"^(posemix[\w.]*)\((.*)\)(?: -> (.*))?$")
MODULES = re.compile(r"\b(?:posemix\.\w+|posemix|numpy\.typing|npt|np|numpy|collections\.abc|typing)\.")
NAN = float("nan")
# Calls of a callable until one succeeds.
MOST_TRIALS = 3000


@dataclasses.dataclass(frozen=True)
class Parameter:
    name: str
    type: str
    required: bool


@dataclasses.dataclass(frozen=True)
class Callee:
    path: str
    parameters: tuple[Parameter, ...]
    is_method: bool

    @property
    def owner(self) -> str:
        return self.path.rpartition(".")[0]

    @property
    def name(self) -> str:
        return self.path.rpartition(".")[2]


def split(text: str) -> list[str]:
    """The parts of a list between commas, but for those within brackets."""
    parts, depth = [""], 0
    for letter in text:
        depth += (letter in "([{") - (letter in ")]}")
        if letter == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts if part.strip()]


def parameter(text: str) -> Parameter:
    head, _, default = text.partition(" = ") if " = " in text else (text, "", "")
    name, _, kind = head.partition(":")
    kind = re.sub(MODULES, "", kind.replace("'", ""))
    return Parameter(name.strip(), kind.strip(), not default)


def callees() -> Iterator[Callee]:
    for line in LISTING.read_text().splitlines():
        found = CALL.match(line)
        if not found:
            continue
        parts = split(found[2])
        first = parts[0].partition(":")[0] if parts else ""
        method = first == "self"
        given = [p for p in parts[1 if first in ("self", "cls") else 0 :] if not p.startswith(("/", "*"))]
        yield Callee(found[1], tuple(parameter(p) for p in given), method)


def resolve(path: str) -> Any:
    """The object at a path of modules and names."""
    names = path.split(".")
    for k in range(len(names), 0, -1):
        try:
            found = importlib.import_module(".".join(names[:k]))
        except ImportError:
            continue
        for name in names[k:]:
            found = getattr(found, name)
        return found
    raise LookupError(path)


# --- good values

RNG = np.random.default_rng(7)
POSE = px.SE3.exp([0.1, -0.2, 0.3, 0.4, 0.1, 0.9])
POSES = px.SE3.exp(RNG.normal(size=(12, 6)) * 0.05)
COVARIANCE = 1e-4 * np.eye(6)
GAUSSIAN = px.ConcentratedGaussian(POSE, COVARIANCE)
PROJECTED = px.ProjectedGaussian(POSE.rotation, np.zeros(6), COVARIANCE)
ROTATION = px.ConcentratedGaussian(px.SO3.exp([0.1, 0.2, 0.3]), 1e-4 * np.eye(3))
CORNERS = np.array([[500.2, 300.1], [531.5, 301.9], [532.3, 270.4], [500.9, 268.8]])
CAMERA = px.CameraModel([600.0, 600.0, 640.0, 512.0])
STEADY = px.DetectorNoise([px.NoiseComponent(covariance=COVARIANCE)])


def slam() -> Any:
    made = px.ObjectSlam(GAUSSIAN, [px.ObjectModel(id="mug")])
    made.step(px.FrameInput(dt=0.1, detections={"mug": POSE}))
    return made


def stamped_slam() -> Any:
    made = px.StampedSlam(GAUSSIAN, [px.ObjectModel(id="mug")])
    made.add(px.Observation([px.ObservationComponent(POSE)], object="mug", stamp_s=0.5))
    return made


def multi_object() -> Any:
    made = px.MultiObjectFilter(GAUSSIAN, [px.ObjectSensor(), px.ObjectSensor()], px.MultiObjectSettings())
    made.update(0, POSE)
    return made


def moving_object() -> Any:
    made = px.MovingObjectFilter(px.ObjectSensor(), px.MotionModels())
    made.update(px.Observation([px.ObservationComponent(POSE)]), px.exact_camera(px.SE3()))
    return made


def simulation() -> Any:
    return px.SimulationConfig(objects=[px.SimulationObject(id="mug")])


def stack(poses: int = 3) -> Any:
    spread = np.diag(np.full(6 * poses, 1e-4))
    return px.ConcentratedGaussian(px.SE3.exp(np.arange(6.0 * poses).reshape(poses, 6) * 0.01), spread)


def gaussian_sum(poses: int = 2) -> Any:
    return px.GaussianSumFilter(px.Mixture([stack(poses)]))


def rig() -> Any:
    made = px.MultiObjectFilter(GAUSSIAN, [px.ObjectSensor()], px.MultiObjectSettings())
    made.add_camera(GAUSSIAN)
    return made


def sequence() -> Any:
    return px.simulate(simulation(), 1).sequence


def slam_run() -> Any:
    return px.run(sequence(), GAUSSIAN, [px.ObjectModel(id="mug")])


# Instances that a constructor without arguments does not make.
MADE: dict[str, Callable[[], Any]] = {
    "ObjectSlam": slam,
    "StampedSlam": stamped_slam,
    "MultiObjectFilter": multi_object,
    "MovingObjectFilter": moving_object,
    "CameraModel": lambda: CAMERA,
    "DetectorNoise": lambda: STEADY,
    "NoiseComponent": lambda: px.NoiseComponent(covariance=COVARIANCE),
    "ConcentratedGaussian": lambda: GAUSSIAN,
    "ProjectedGaussian": lambda: PROJECTED,
    "Mixture": lambda: px.Mixture([GAUSSIAN, px.ConcentratedGaussian(POSE * POSES[0], 2 * COVARIANCE)], [0.6, 0.4]),
    "SE3": lambda: POSE,
    "SO3": lambda: POSE.rotation,
    "RandomStream": lambda: px.RandomStream(1),
    "Observation": lambda: px.Observation([px.ObservationComponent(POSE)], object="mug"),
    "SimulationConfig": simulation,
    "GaussianSumFilter": gaussian_sum,
    "FrameInput": lambda: px.FrameInput(dt=0.1, detections={"mug": POSE}),
    "FrameEstimate": lambda: slam().step(px.FrameInput(dt=0.1, detections={"mug": POSE})),
    "Sequence": sequence,
    "SlamRun": slam_run,
    "SlamMethod": lambda: px.slam_methods()[0],
    "Relocalisation": lambda: px.relocalise(slam(), slam()),
    "SimulatedSequence": lambda: px.simulate(simulation(), 1),
    "TagMinimum": lambda: px.tag_minima(CORNERS, 0.1, CAMERA)[0],
    "NoiseFit": lambda: px.fit_noise(px.SE3.identity(40), px.SE3.exp(RNG.normal(size=(40, 6)) * 0.01)),
}
# Methods that need more than an instance of their class has.
OWNERS: dict[str, Callable[[], Any]] = {
    "ConcentratedGaussian.conditional": stack,
    "ConcentratedGaussian.marginal": stack,
    "ConcentratedGaussian.relative_pose": stack,
    "Mixture.marginal": lambda: px.Mixture([stack()]),
    "Mixture.relative_pose": lambda: px.Mixture([stack()]),
    "MultiObjectFilter.add_camera": lambda: px.MultiObjectFilter(GAUSSIAN, [], px.MultiObjectSettings()),
    "MultiObjectFilter.extrinsic": rig,
}
# Types whose values are made by a callable of another name.
ALSO: dict[str, list[str]] = {
    "G": ["SE3", "SO3"], "X": ["ConcentratedGaussian", "ProjectedGaussian", "SE3", "Mixture"],
    "D": ["ConcentratedGaussian", "ProjectedGaussian"], "Self": ["SE3", "SO3"],
}  # fmt: skip
NAMED: dict[str, list[Any]] = {
    **dict.fromkeys(["q", "q_motion", "at_rest", "change", "added", "constant"], [COVARIANCE]),
    "name": ["particle", "mug"], "state": [b"no state"], "indices": [[1, 2]],
    "values": [px.SE3.exp(np.zeros((2, 6)))], "axis": [[0.0, 0.0, 1.0]], "entry": [{"diameter": 100.0}],
}  # fmt: skip
ARRAYS: dict[str, list[Any]] = {
    "covariance": [COVARIANCE, 1e-4 * np.eye(3), np.tile(COVARIANCE, (12, 1, 1))],
    "corners": [CORNERS],
    "weights": [np.full(12, 1 / 12), np.array([1.0])],
    "intrinsics": [[600.0, 600.0, 320.0, 240.0]],
    "successes": [np.arange(12) % 2 == 0],
    "probabilities": [np.linspace(0.05, 0.95, 12)],
    "stamps": [np.arange(12) * 0.1],
    "groups": [np.arange(12) // 4],
}
SHAPES: list[Any] = [
    0.3, np.full(3, 0.1), np.full(6, 0.01), np.full(7, 0.378), np.full(4, 0.5), 1e-4 * np.eye(6), 1e-4 * np.eye(3),
    np.eye(4), RNG.normal(size=(12, 3)), RNG.normal(size=(12, 6)) * 0.1, RNG.normal(size=(12, 2)),
    np.linspace(0.1, 0.9, 12), np.eye(3), np.eye(12), RNG.normal(size=(12, 7)), np.tile(COVARIANCE, (12, 1, 1)),
    np.full(2, 0.2), np.full((2, 2), 0.3),
]  # fmt: skip


def good(kind: str, name: str, depth: int = 0) -> list[Any]:
    """Values of a type, the likeliest first."""
    found: list[Any] = list(NAMED.get(name, []))
    for part in re.split(r"\s*\|\s*(?![^\[]*\])", kind):
        found += of_one_type(part, name, depth)
    return found


def of_one_type(kind: str, name: str, depth: int) -> list[Any]:
    simple = {
        "float": [0.5, 1.0, 2.0], "int": [1, 0, 3], "bool": [False], "str": ["mug", "odom"], "bytes": [b"x"],
        "None": [None], "SupportsFloat": [0.5], "object": [0.5],
    }  # fmt: skip
    if kind in simple:
        return simple[kind]
    if kind in ("ArrayLike", "FloatArray", "ndarray") or kind.startswith(("NDArray", "ndarray")):
        return [*ARRAYS.get(next((k for k in ARRAYS if k in name), ""), []), *SHAPES]
    if kind == "SE3":
        return [POSE, POSES]
    if inner := re.fullmatch(r"(?:Sequence|list|Iterable|List)\[(.*)\]", kind):
        values = good(inner[1], name, depth)
        return [[value] for value in values[:4]] + [[value] * 3 for value in values[:2]]
    if inner := re.fullmatch(r"tuple\[(.*)\]", kind):
        return [tuple(good(part, name, depth)[0] for part in split(inner[1]) if part != "...")]
    if inner := re.fullmatch(r"(?:Mapping|dict)\[(.*)\]", kind):
        key, value = split(inner[1])
        return [{good(key, name, depth)[0]: one} for one in good(value, name, depth)[:2]]
    if kind.startswith("Mixture[ProjectedGaussian"):
        return [px.Mixture([PROJECTED, PROJECTED])]
    plain = re.sub(r"\[.*", "", kind).rpartition(".")[2]
    if plain in ALSO:
        return [value for one in ALSO[plain] for value in of_one_type(one, name, depth)]
    if plain in MADE:
        made = [MADE[plain]()]
        return [*made, ROTATION] if plain == "ConcentratedGaussian" else made
    cls = getattr(px, plain, None)
    if inspect.isclass(cls) and issubclass(cls, enum.Enum):
        return [next(iter(cls))]
    if inspect.isclass(cls) and depth < 3:
        return instances(plain, depth + 1)
    return []


def instances(cls: str, depth: int = 0) -> list[Any]:
    """At most one instance, by the constructor of the listing."""
    if cls in MADE:
        return [MADE[cls]()]
    found = next((c for c in ALL if c.path == f"posemix.{cls}.__init__"), None)
    made = found and working(dataclasses.replace(found, is_method=False), getattr(px, cls), depth)
    return [made[1]] if made else []


def working(callee: Callee, function: Any, depth: int = 0) -> tuple[dict[str, Any], Any] | None:
    """Arguments of a call that succeeds, and its result."""
    required = [p for p in callee.parameters if p.required]
    choices = [good(p.type, p.name, depth) for p in required]
    for values in itertools.islice(itertools.product(*choices), MOST_TRIALS):
        arguments = dict(zip((p.name for p in required), values, strict=True))
        try:
            return arguments, function(**arguments)
        except Exception:
            continue
    return None


# The listing leaves out constructors without parameters.
ALL = list(callees())
