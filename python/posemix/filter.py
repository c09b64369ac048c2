# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Filters over the poses of a camera and of objects; see `posemix.slam` for whole recordings."""

from posemix.filters import *
from posemix.noise import *
