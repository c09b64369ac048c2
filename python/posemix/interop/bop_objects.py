# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Symmetries of BOP models as the filters take them; part of `posemix.interop.bop`."""

from __future__ import annotations

import numpy.typing as npt

from posemix.interop.bop_models import Model, noise_modes
from posemix.interop.bop_models import SymmetryAxis as BopAxis
from posemix.noise import (
    DetectorNoise,
    NoiseComponent,
    NoiseFrame,
    NullNoise,
    SymmetryAxis,
    SymmetryGroup,
)

__all__ = ["detector_noise", "symmetry_group"]


def _axis(axis: BopAxis) -> SymmetryAxis:
    return SymmetryAxis(direction=axis.direction, point=axis.point)


def symmetry_group(model: Model) -> SymmetryGroup:
    """The group of an object's symmetries, for `ObjectModel.symmetries`.

    Raises
    ------
    ValueError
        For symmetries that are no group: a product that is missing, an axis that an element moves.
    """
    return SymmetryGroup(model.elements, [_axis(axis) for axis in model.axes])


def detector_noise(
    model: Model, covariance: npt.ArrayLike, *, null: NullNoise | None = None
) -> DetectorNoise:
    """The noise of a detector that cannot tell the symmetries of an object; see `noise_modes`.

    For a filter without `ObjectModel.symmetries`, such as the Gaussian-sum filter. Where the filter knows the
    group, its noise is that of the detector alone.

    Parameters
    ----------
    model : Model
        Of one object.
    covariance : array_like, shape (6, 6)
        Of the detector's own error along the object's axes.
    null : NullNoise, optional
        Detections of nothing; its weight is a probability, below one.
    """
    share = 1.0 - (null.weight if null is not None else 0.0)
    components = [
        NoiseComponent(
            weight=share * mode.weight,
            covariance=mode.covariance,
            frame=NoiseFrame.object,
            offset=mode.offset,
        )
        for mode in noise_modes(model, covariance)
    ]
    return DetectorNoise(components, null)
