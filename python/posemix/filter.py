# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Filters over the poses of a camera and of objects, one call per prediction or update.

See `posemix.slam` for whole recordings.
"""

from posemix import noise
from posemix._core import (
    Detection, GaussianSumFilter, GaussianSumSettings, MultiObjectFilter, MultiObjectSettings, NoiseUse,
    ObjectHypothesis, ObjectUpdateReport, RobustLoss, Summary, UpdateReport, UpdateRule,
)  # fmt: skip
from posemix.noise import *

__all__ = [
    "Detection", "GaussianSumFilter", "GaussianSumSettings", "MultiObjectFilter", "MultiObjectSettings", "NoiseUse",
    "ObjectHypothesis", "ObjectUpdateReport", "RobustLoss", "Summary", "UpdateReport", "UpdateRule", *noise.__all__,
]  # fmt: skip
