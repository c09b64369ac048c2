# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""ROS bags without ROS: detections and odometry in, estimates and mixtures out.

Reads ROS 2 bags (sqlite3 and MCAP) and ROS 1 bags through the package rosbags: `pip install posemix[bags]`.
"""

from posemix.bags.read import Detections as Detections, Recording as Recording, read as read
from posemix.bags.transforms import TransformBuffer as TransformBuffer
from posemix.bags.write import Track as Track, read_track as read_track, write as write
