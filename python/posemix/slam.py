# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Object SLAM: camera and objects from detections, live (`ObjectSlam`) or over a recording (`run`)."""

from posemix.evaluation import *
from posemix.live import *
from posemix.recording import *
from posemix.runs import *
from posemix.simulation import *
