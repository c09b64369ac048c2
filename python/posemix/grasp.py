# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Grasps under pose uncertainty: probabilities of success, error mixtures of estimators, scores of predictions."""

from posemix.error_mixture import *
from posemix.scores import *
from posemix.success import *
