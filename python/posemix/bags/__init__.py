# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""ROS bags without ROS: detections and odometry in, estimates and mixtures out.

Reads ROS 2 bags (sqlite3 and MCAP) and ROS 1 bags through the package rosbags: `pip install posemix[bags]`.
"""

from posemix.bags.read import Detections, Recording, read
from posemix.bags.transforms import TransformBuffer
from posemix.bags.write import Track, read_track, write

__all__ = ["Detections", "Recording", "Track", "TransformBuffer", "read", "read_track", "write"]
