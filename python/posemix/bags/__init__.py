# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Reads detections and odometry from ROS bags and writes estimates and mixtures, without ROS.

Supports ROS 2 bags (sqlite3 and MCAP) and ROS 1 bags through the package rosbags: `pip install posemix[bags]`.
"""

from posemix.bags.observations import is_placeholder_covariance, weights_of_scores
from posemix.bags.poses import read_poses
from posemix.bags.read import Detections, Recording, read
from posemix.bags.slam import BagRun, models_of, run_slam, track_objects
from posemix.bags.states import TrackState
from posemix.bags.transforms import TransformBuffer
from posemix.bags.write import Track, read_track, write

__all__ = [
    "BagRun", "Detections", "Recording", "Track", "TrackState", "TransformBuffer", "is_placeholder_covariance",
    "models_of", "read", "read_poses", "read_track", "run_slam", "track_objects", "weights_of_scores", "write",
]  # fmt: skip
