# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Pictures of poses, densities and mixtures with matplotlib: `pip install posemix[plot]`.

Every function draws on the given axes, labels them with units, and returns the artists. Functions for space take
two-dimensional axes and a plane, or axes with the projection "3d". The colours are those of the report, which
colour-blind readers can distinguish.
"""

from posemix.plot.path import trajectory
from posemix.plot.series import axis_marginal, chi_square_quantile, mode_probabilities, nees
from posemix.plot.space import ellipsoid, flags, position_contours, position_covariance
from posemix.plot.style import PALETTE

__all__ = [
    "PALETTE", "axis_marginal", "chi_square_quantile", "ellipsoid", "flags", "mode_probabilities", "nees",
    "position_contours", "position_covariance", "trajectory",
]  # fmt: skip
