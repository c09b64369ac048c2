# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Logs poses, densities and mixtures to Rerun: `pip install posemix[rerun]`.

Every function takes an entity path and logs at the current time, which `set_time` sets. The default of `recording` is
the current one of rerun.init. A pose T_world_x is logged in the coordinates of the world, so its path must be below the
entity of the world, not below that of x. Lengths are in metres.
"""

from posemix.rerun.runs import log_run, log_state
from posemix.rerun.shapes import (
    log_ellipsoid, log_hypotheses, log_pose, log_scalars, log_tracking, log_trajectory, set_time,
)  # fmt: skip

__all__ = [
    "log_ellipsoid", "log_hypotheses", "log_pose", "log_run", "log_scalars", "log_state", "log_tracking",
    "log_trajectory", "set_time",
]  # fmt: skip
