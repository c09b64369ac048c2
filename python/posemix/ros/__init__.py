# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""A node for ROS 2: detections and odometry in, calibrated mixtures of poses out. docs/ros.md describes it.

The program `posemix-ros` runs the node in the user's own ROS 2 (rclpy), which posemix does not install. What the node
does with messages, transforms and time is in modules that need no ROS: `Engine` and what it is made of.
"""

from posemix.ros.configuration import Configuration, Source, configuration
from posemix.ros.engine import Engine
from posemix.ros.estimates import EngineCounts, LiveEstimate
from posemix.ros.messages import Image, images_of, symmetries_of
from posemix.ros.parameters import Parameter, markdown, parameters
from posemix.ros.transforms import LiveTransforms

__all__ = [
    "Configuration", "Engine", "EngineCounts", "Image", "LiveEstimate", "LiveTransforms", "Parameter", "Source",
    "configuration", "images_of", "markdown", "parameters", "symmetries_of",
]  # fmt: skip
