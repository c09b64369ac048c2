# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Live views of a running estimator: in Rerun, in Foxglove, and a recording for the HTML report. docs/live-view.md.

A view takes the present estimate of a `StampedSlam` by ``view.update(slam)``, whenever there is a new one.
"""

from posemix.live_view.background import BackgroundView
from posemix.live_view.foxglove_view import FoxgloveView
from posemix.live_view.frames import Frustum, LiveFrame
from posemix.live_view.opening import open_view
from posemix.live_view.recording import LiveRecording
from posemix.live_view.rerun_view import RerunView
from posemix.live_view.view import View

__all__ = [
    "BackgroundView", "FoxgloveView", "Frustum", "LiveFrame", "LiveRecording", "RerunView", "View", "open_view",
]  # fmt: skip
