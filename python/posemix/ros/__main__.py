# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The program `posemix-ros`."""

from __future__ import annotations

import sys

_NEEDED = """posemix-ros: {error}
It runs in a ROS 2 that is installed (Humble or later) and sourced, with its Python:
    source /opt/ros/$ROS_DISTRO/setup.bash
    sudo apt install ros-$ROS_DISTRO-vision-msgs ros-$ROS_DISTRO-diagnostic-msgs
Conda's RoboStack has the same packages."""


def main(arguments: list[str] | None = None) -> int:
    """Runs the node until it is interrupted; arguments are those of ROS, such as --ros-args --params-file FILE."""
    try:
        import rclpy
        from rclpy.executors import ExternalShutdownException
        from rclpy.lifecycle import TransitionCallbackReturn

        from posemix.ros.node import PosemixNode
    except ImportError as error:
        print(_NEEDED.format(error=error), file=sys.stderr)
        return 1
    rclpy.init(args=arguments)
    try:
        node = PosemixNode()
        if node.get_parameter("autostart").value:
            for step in (node.trigger_configure, node.trigger_activate):
                if step() != TransitionCallbackReturn.SUCCESS:
                    return 1
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
