# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Uncertain 6-DoF poses as mixtures of Gaussians.

Conventions: ``T_a_b`` maps points of frame b into frame a; tangent vectors are rotation (rad) before translation
(m); the perturbation of a concentrated Gaussian is on the left, ``X = Exp(xi) X0``; quaternions are ``x y z w``.
"""

from posemix._core import (
    CompositionRule as CompositionRule, ConversionRule as ConversionRule, ConversionSettings as ConversionSettings,
    DistanceMetric as DistanceMetric, DivergenceSamplingSettings as DivergenceSamplingSettings,
    EmSettings as EmSettings, EmStatus as EmStatus, FuseSettings as FuseSettings, FusionRule as FusionRule,
    LargeLoss as LargeLoss, MergeRule as MergeRule, MergeSettings as MergeSettings, MomentSettings as MomentSettings,
    PairRule as PairRule, PairWeight as PairWeight, ProjectedFuseSettings as ProjectedFuseSettings,
    ProjectedMixtureComposeSettings as ProjectedMixtureComposeSettings,
    ProjectedMixtureFuseSettings as ProjectedMixtureFuseSettings, ReductionSettings as ReductionSettings,
    TransportJacobian as TransportJacobian, version as version,
)  # fmt: skip
from posemix.density import *
from posemix.divergence import *
from posemix.em import *
from posemix.fiducials import *
from posemix.filter import *
from posemix.grasp import *
from posemix.io import *
from posemix.lie import *
from posemix.mixture import *
from posemix.operations import *
from posemix.random import *
from posemix.slam import *

__version__ = version
