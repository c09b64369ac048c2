# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Existence, health and motion of a tracked object as diagnostic messages."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from posemix._core import ObjectEstimate, TrackHealth

__all__ = ["TrackState"]

DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"

_ERRORS = (TrackHealth.inconsistent, TrackHealth.lost)
_MODEL = "motion_model_"


@dataclass(frozen=True)
class TrackState:
    """State of the track of an object at one time.

    Attributes
    ----------
    health : TrackHealth
        Whether the track is confirmed, and as the noise says.
    existence : float or None
        Probability that there is such an object.
    register_again : bool
        Whether the track is lost or inconsistent for some time.
    motion_models : tuple of float
        Probabilities of the models of motion, of an object that moves.
    """

    health: TrackHealth
    existence: float | None = None
    register_again: bool = False
    motion_models: tuple[float, ...] = ()

    @classmethod
    def of(cls, estimate: ObjectEstimate) -> TrackState:
        """The state in an estimate."""
        return cls(
            estimate.health, estimate.existence, estimate.register_again, tuple(estimate.motion_models)
        )

    def values(self) -> dict[str, str]:
        """The state but for the health, as texts that are read back to the last bit."""
        found = {"register_again": str(self.register_again).lower()}
        if self.existence is not None:
            found["existence"] = repr(self.existence)
        return found | {f"{_MODEL}{i}": repr(p) for i, p in enumerate(self.motion_models)}


def status_of(state: TrackState, name: str, types: Mapping[str, Any]) -> Any:
    """A diagnostic_msgs/DiagnosticStatus: good is OK, lost and inconsistent are errors, others warnings."""
    level = 0 if state.health == TrackHealth.good else 2 if state.health in _ERRORS else 1
    pair = types["diagnostic_msgs/msg/KeyValue"]
    return types["diagnostic_msgs/msg/DiagnosticStatus"](
        level=level, name=name, message=state.health.name, hardware_id="",
        values=[pair(key=key, value=value) for key, value in state.values().items()],
    )  # fmt: skip


def state_of(status: Any) -> TrackState:
    """The state in a status that `status_of` made."""
    values = {pair.key: pair.value for pair in status.values}
    existence = values.get("existence")
    models = [key for key in values if key.startswith(_MODEL)]
    return TrackState(
        TrackHealth[status.message],
        None if existence is None else float(existence),
        values.get("register_again") == "true",
        tuple(float(values[f"{_MODEL}{i}"]) for i in range(len(models))),
    )
