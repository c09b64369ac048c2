# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Conversions from and to the conventions of other packages and files, by name.

There is one module per package; importing it does not need the package. If a convention does not determine something
(side, order, reading, frame), that is an argument without a default. Conversions of covariances are to first order in
the error and exact in the mean; all others are exact. docs/interop.md has a table of all.
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
