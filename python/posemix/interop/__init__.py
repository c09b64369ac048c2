# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Conventions of other packages and files, converted by name.

One module per ecosystem; none of the packages is needed to import them. What a convention leaves open (side,
order, reading, frame) is an argument without a default. Conversions of covariances are to first order in the
error, exact in the mean; the rest is exact. docs/interop.md is the table of all.
"""

from posemix.interop import (
    bop,
    conventions,
    euler,
    evo,
    g2o,
    gtsam,
    jaxlie,
    kitti,
    manif,
    mrpt,
    navlie,
    pytransform3d,
    ros,
    scipy,
    sophus,
    symforce,
)

__all__ = [
    "bop", "conventions", "euler", "evo", "g2o", "gtsam", "jaxlie", "kitti", "manif",
    "mrpt", "navlie", "pytransform3d", "ros", "scipy", "sophus", "symforce",
]  # fmt: skip
