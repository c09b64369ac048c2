# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Conventions of other packages and files, converted by name.

One module per ecosystem; none of the packages is needed to import them. What a convention leaves open (side,
order, reading, frame) is an argument without a default. Conversions of covariances are to first order in the
error, exact in the mean; the rest is exact. docs/interop.md is the table of all.
"""

from posemix.interop import (
    bop as bop,
    conventions as conventions,
    euler as euler,
    evo as evo,
    g2o as g2o,
    gtsam as gtsam,
    jaxlie as jaxlie,
    kitti as kitti,
    manif as manif,
    mrpt as mrpt,
    navlie as navlie,
    pytransform3d as pytransform3d,
    ros as ros,
    scipy as scipy,
    sophus as sophus,
    symforce as symforce,
    tum as tum,
)
