# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The state of all objects in words and numbers."""

from __future__ import annotations

import numpy as np

from posemix._core import ObjectEstimate, TrackHealth
from posemix.live_view.frames import LiveFrame
from posemix.plot.space import position_covariance

__all__ = ["health_text", "label_of", "position_sd_m", "state_table"]


def health_text(estimate: ObjectEstimate) -> str:
    """Health of a track in words."""
    return estimate.health.name + (": register again" if estimate.register_again else "")


def label_of(name: str, estimate: ObjectEstimate) -> str:
    """The name of an object with its health, where that is not good."""
    return name if estimate.health == TrackHealth.good else f"{name}, {estimate.health.name}:"


def position_sd_m(estimate: ObjectEstimate) -> float:
    """The largest standard deviation of the position in the world [m], in any direction."""
    assert estimate.world is not None
    covariance = position_covariance(estimate.world.mean, estimate.world.covariance)
    return float(np.sqrt(max(np.linalg.eigvalsh(covariance)[-1], 0.0)))


def _share(value: float | None) -> str:
    return "" if value is None else f"{value:.3f}"


def state_table(frame: LiveFrame) -> str:
    """A table in Markdown with a row per object."""
    lines = [
        "| object | health | exists | right mode | hypotheses | position sd |",
        "|---|---|---|---|---|---|",
    ]
    for name in frame.names:
        of_object = frame.estimate.object(name)
        cells = (
            name.replace("|", "\\|"), health_text(of_object), _share(of_object.existence),
            _share(of_object.mode_probability), str(len(frame.hypotheses[name])),
            f"{1e3 * position_sd_m(of_object):.1f} mm",
        )  # fmt: skip
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines if frame.names else ["No object was seen so far."])
