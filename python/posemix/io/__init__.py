# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Files: sequence files and results of object SLAM, mixtures, trajectories, BOP. docs/formats.md describes them.

Readers raise ValueError ``file:line: got ..., expected ...``; writers write a file or a folder as a whole or not at
all, and raise OSError if the system refuses.
"""

from posemix.io import bop, grasps, jobs, mixtures, poses, reports
from posemix.io.bop import *
from posemix.io.grasps import *
from posemix.io.jobs import *
from posemix.io.mixtures import *
from posemix.io.poses import *
from posemix.io.reports import *

__all__ = [
    *bop.__all__,
    *grasps.__all__,
    *jobs.__all__,
    *mixtures.__all__,
    *poses.__all__,
    *reports.__all__,
]
