# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The node's parameters: its own, and one for every setting of the filter."""

from __future__ import annotations

import copy
import enum
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias, TypeVar, cast

import numpy as np

from posemix._core import ObjectSlamSettings, StampedSlamSettings, StampJump

__all__ = ["Parameter", "Value", "markdown", "parameters", "settings_of"]

Value: TypeAlias = bool | int | float | str | list[str] | list[float]
T = TypeVar("T")


@dataclass(frozen=True)
class Parameter:
    """A parameter of the node.

    Attributes
    ----------
    name : str
        Name; those of sources and of classes have one for each, below its name.
    default : bool, int, float, str, list of str or list of float
        Value unless one is given, which has its type, too.
    text : str
        Meaning with the unit.
    choices : tuple of str
        Words that are allowed; empty: any.
    """

    name: str
    default: Value
    text: str
    choices: tuple[str, ...] = ()

    def checked(self, value: Any) -> Any:
        """The value itself; raises ValueError naming the parameter and what was expected."""
        if self.choices and value not in self.choices:
            raise ValueError(f"{self.name} is '{value}'; expected one of {', '.join(self.choices)}")
        return value


# An array without elements has no type in ROS: one empty name stands for none.
NONE = [""]
TYPES = ("Detection3DArray", "Detection2DArray")
MOTIONS = ("static", "put_down", "random_walk", "constant_velocity", "calm_and_agile")

NODE = (
    Parameter("autostart", True, "Whether the node configures and activates itself when it starts."),
    Parameter("sources", ["detections"], "Names of the detectors; each has the parameters SOURCE.*."),
    Parameter("classes", NONE, "Classes with parameters CLASS.* of their own."),
    Parameter("on_sight", True, "Whether a class that is not among `classes` is an object when it is first detected."),
    Parameter(
        "on_sight_instances", 8,
        "Number of objects of such a class, once the detector shows several in one image; 1: ever the best one alone.",
    ),
    Parameter("world_frame", "map", "Frame of the objects."),
    Parameter("odom_frame", "odom", "Frame relative to which the camera's motion is known."),
    Parameter("odometry_topic", "", "Topic of nav_msgs/Odometry; empty: the odometry is in /tf."),
    Parameter("camera_frame", "", "Frame of the camera, where there is one; empty: that of the first detections."),
    Parameter("body_frame", "base_link", "Frame on which the cameras of a rig stand."),
    Parameter("cameras", NONE, "Frames of the cameras of a rig, by the messages' headers; none: there is one camera."),
    Parameter(
        "camera_info_topics", NONE, "Topics of sensor_msgs/CameraInfo, for `in_view` in the diagnostics of objects."
    ),
    Parameter("max_gap_s", 0.2, "Longest gap between two transforms that is interpolated [s]."),
    Parameter(
        "transform_timeout_s", 0.5,
        "Time for which an image waits for odometry and transforms at its stamp [s]; then it goes without odometry.",
    ),
    Parameter("queue_size", 100, "Number of images that may wait; of more the oldest are dropped."),
    Parameter("input_depth", 10, "Depth of the queues of detections and odometry in the middleware."),
    Parameter("empty_is_image", True, "Whether an array without detections is an image in which nothing was detected."),
    Parameter("start_rotation_sd_deg", 0.05, "Error of the camera's pose in the world at the start [deg]."),
    Parameter("start_translation_sd_m", 0.002, "Error of the same [m]."),
    Parameter("noise_file", "", "TOML file with tables [noise.NAME], as in sequence files; for SOURCE.noise."),
    Parameter("models_info", "", "models_info.json of BOP, for the symmetries of what is in classes."),
    Parameter("symmetries_topic", "", "Latched topic of happypose_msgs/ObjectSymmetriesArray; empty: none."),
    Parameter(
        "replay_images", 600,
        "Number of images up to which a run is played again when models change, as by symmetries that come late; in a "
        "longer one the objects go on from where they are.",
    ),
    Parameter(
        "map_file", "", "File of ~/save and ~/load, and of load_map and save_map; may be set at any time."
    ),
    Parameter("load_map", False, "Whether map_file is loaded, where it is there, when the node is configured."),
    Parameter("save_map", False, "Whether map_file is saved when the node is deactivated or ends."),
    Parameter(
        "map_goes_on", False,
        "Whether the run of a map that is loaded before the first image goes on, as after a restart of the node alone; "
        "else the map is found again by its objects.",
    ),
    Parameter("forget_ids", NONE, "Names of the objects that ~/forget forgets; may be set at any time."),
    Parameter("least_existence", 0.5, "Objects that exist with a smaller probability are not among ~/objects."),
    Parameter("publish_tf", True, "Whether /tf has the leading hypothesis of every confirmed object."),
    Parameter(
        "publish_world_tf", True,
        "Whether /tf has world_frame -> odom_frame (without odometry: the body's root), if nothing else has.",
    ),
    Parameter("tf_prefix", "", "Prefix of the frames of objects."),
    Parameter("transform_time_offset_s", 0.0, "Added to the stamps in /tf [s]."),
    Parameter("markers_hz", 5.0, "Largest rate of ~/markers [Hz]; 0: none."),
    Parameter("markers_sigmas", 3.0, "Half axes of the ellipsoids in standard deviations."),
    Parameter("diagnostics_hz", 1.0, "Rate of /diagnostics [Hz]."),
    Parameter("view", "none", "Viewer that shows what is going on.", ("none", "rerun", "foxglove")),
    Parameter(
        "view_address", "",
        "Address of the view or its file, as of `open_view`; empty: :9876 for Rerun, 127.0.0.1:8765 for Foxglove.",
    ),
    Parameter("view_hz", 10.0, "Largest rate of the view, and of the recording for the report [Hz]."),
    Parameter(
        "report_folder", "",
        "Folder in which every run has one with its recording and, from deactivate, shutdown or ~/report on, its "
        "report; empty: none.",
    ),
    Parameter("report_frames", 3000, "Frames of the recording at most; of a longer run every so many-th is left."),
)  # fmt: skip

SOURCE = (
    Parameter("topic", "", "Topic; empty: ~/SOURCE."),
    Parameter("type", TYPES[0], "Type of the messages, of vision_msgs.", TYPES),
    Parameter("frame", "", "Frame of the camera in place of that in the messages, which may not be the optical one."),
    Parameter(
        "pose", "result", "Pose of a detection: those of its results, or the centre of its box.", ("result", "bbox")
    ),
    Parameter("least_score", 0.0, "Detections with a smaller score are left out."),
    Parameter("noise", "", "Name of the noise in noise_file; empty: by the next three."),
    Parameter("rotation_sd_deg", 0.0, "Error of the rotation [deg]; 0: that of a typical detector."),
    Parameter("translation_sd_m", 0.0, "Error of the position [m]; 0: that of a typical detector."),
    Parameter("clutter", 0.05, "With the two: probability of a detection that is of no object."),
    Parameter(
        "given_covariance", "", "Use of covariances in messages: `given_covariance` of the noise; empty: as it says.",
        ("", "scaled", "as_given", "ignored"),
    ),
)  # fmt: skip

CLASS = (
    Parameter("instances", 1, "Number of objects of the class; more than one are told apart by where they are."),
    Parameter("bop_id", 0, "Number in models_info; 0: the digits at the end of the class."),
    Parameter("motion", "static", "Motion of the objects, with the defaults of its model.", MOTIONS),
)

# Settings that the node has for itself, and lists.
_LEFT_OUT = {"cameras", "on_sight", "frames", "filter.has_odometry"}


def parameters() -> list[Parameter]:
    """All parameters of the node but those of sources and classes: its own, and the settings."""
    return [*NODE, *settings_parameters()]


def settings_parameters() -> list[Parameter]:
    """One parameter for every number, switch and word of the settings."""
    return [parameter for prefix, settings in _roots() for parameter in _fields(prefix, settings)]


def _roots() -> Iterator[tuple[str, Any]]:
    settings = ObjectSlamSettings()
    yield "", settings.tracker
    yield "motion.", settings.motion
    # A bag that is played again, or a simulation that starts again, is no error of a live system.
    yield "stamped.", StampedSlamSettings(on_jump_back=StampJump.reset)


def _is_settings(value: Any) -> bool:
    return hasattr(type(value), "__setstate__") and not isinstance(value, (enum.Enum, np.ndarray))


def _texts(cls: type) -> dict[str, str]:
    """The texts of the fields of settings, by name and without their defaults."""
    found = re.findall(r"^(\w+) : [^\n]*\n    (.*)", cls.__doc__ or "", re.MULTILINE)
    return {name: re.sub(r" Default .*$", "", text) for name, text in found}


def _values(settings: Any) -> dict[str, Any]:
    state: dict[str, Any] = settings.__getstate__()
    return {name: value for name, value in state.items() if value is not None}


def _fields(prefix: str, settings: Any) -> Iterator[Parameter]:
    texts = _texts(type(settings))
    for name, value in _values(settings).items():
        full = prefix + name
        if full in _LEFT_OUT:
            continue
        if isinstance(value, enum.Enum):
            words = tuple(member.name for member in type(value))
            yield Parameter(full, value.name, texts[name], words)
        elif isinstance(value, np.ndarray):
            yield Parameter(full, [float(v) for v in value.ravel()], f"{texts[name]} Row by row, or the diagonal.")
        elif isinstance(value, (bool, int, float, str)):
            yield Parameter(full, value, texts[name])
        elif _is_settings(value):
            yield from _fields(full + ".", value)


def settings_of(settings: T, values: Mapping[str, Any], prefix: str) -> T:
    """Settings with the values of the parameters whose names begin with the prefix.

    Raises
    ------
    ValueError
        Naming a parameter, for a word that there is not and an array of another length.
    """
    made: Any = copy.copy(settings)
    for name, value in _values(settings).items():
        full = prefix + name
        if full in _LEFT_OUT:
            continue
        if _is_settings(value):
            setattr(made, name, settings_of(value, values, full + "."))
        elif full in values:
            setattr(made, name, _converted(full, value, values[full]))
    return cast(T, made)


def _converted(name: str, old: Any, value: Any) -> Any:
    if isinstance(old, enum.Enum):
        words = [member.name for member in type(old)]
        if value not in words:
            raise ValueError(f"{name} is '{value}'; expected one of {', '.join(words)}")
        return type(old)[value]
    if isinstance(old, np.ndarray):
        numbers = np.array(value, dtype=np.float64)
        if old.ndim == 2 and numbers.shape == old.shape[:1]:
            return np.diag(numbers)
        if numbers.shape != (old.size,):
            raise ValueError(f"{name} has {numbers.size} numbers; expected {old.size}")
        return numbers.reshape(old.shape)
    return value


def _row(parameter: Parameter, prefix: str = "") -> str:
    default = parameter.default
    if isinstance(default, list):
        shown = ", ".join(repr(v) for v in default if v != "") or "none"
        if len(default) == 36:
            diagonal = [default[7 * i] for i in range(6)]
            shown = "diagonal " + ", ".join(f"{v:.4g}" for v in diagonal)
    elif isinstance(default, bool):
        shown = str(default).lower()
    else:
        shown = f"{default:.6g}" if isinstance(default, float) else str(default)
    words = f" One of {', '.join(f'`{w}`' for w in parameter.choices if w)}." if parameter.choices else ""
    return f"| `{prefix}{parameter.name}` | {parameter.text}{words} | {shown} |"


def markdown() -> str:
    """The table of all parameters, as docs/ros.md has it."""
    groups: list[tuple[str, Iterable[Parameter], str]] = [
        ("Of the node", NODE, ""),
        ("Of every source, `SOURCE.` is its name", SOURCE, "SOURCE."),
        ("Of every class in `classes`", CLASS, "CLASS."),
        ("Settings of the filter", settings_parameters(), ""),
    ]
    lines = []
    for title, group, prefix in groups:
        lines += [f"### {title}", "", "| parameter | meaning | default |", "|---|---|---|"]
        lines += [_row(parameter, prefix) for parameter in group]
        lines.append("")
    return "\n".join(lines)
