# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""navlie: SE3State with a `direction`, rotation first (the groups are those of pymlg)."""

from __future__ import annotations

from typing import Any

import numpy as np

from posemix._peers import peer
from posemix.density import ConcentratedGaussian
from posemix.interop.conventions import Side, density_from, density_to
from posemix.lie import SE3

__all__ = ["from_state", "to_state"]


def from_state(state: Any) -> ConcentratedGaussian[SE3]:
    """The density of a navlie StateWithCovariance with an SE3State; exact.

    The side of the perturbation is the `direction` of the state.
    """
    pose = SE3.from_matrix(np.asarray(state.state.value, dtype=np.float64))
    return density_from(
        pose, state.covariance, side=state.state.direction, order="rotation_first"
    )


def to_state(
    density: ConcentratedGaussian[SE3], *, direction: Side, stamp: float | None = None
) -> Any:
    """A navlie StateWithCovariance, the inverse of `from_state`.

    Parameters
    ----------
    density : ConcentratedGaussian
        The density of one pose.
    direction : {"left", "right"}
        Direction of perturbation of the state (navlie's own default is "right").
    stamp : float, optional
        Time of the state [s].
    """
    mean, covariance = density_to(density, side=direction, order="rotation_first")
    lib = peer("navlie.lib", "posemix.interop.navlie", "navlie")
    types = peer("navlie.types", "posemix.interop.navlie", "navlie")
    state = lib.SE3State(mean.matrix(), stamp=stamp, direction=direction)
    return types.StateWithCovariance(state, covariance)
