# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Grasps under pose uncertainty: how likely one succeeds, how estimators err, and how good predictions are."""

from posemix.error_mixture import *
from posemix.scores import *
from posemix.success import *
