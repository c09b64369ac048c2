# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The program `posemix-ros`."""

from __future__ import annotations

import gc
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
    node = None
    try:
        node = PosemixNode()
        if node.get_parameter("autostart").value:
            for step in (node.trigger_configure, node.trigger_activate):
                if step() != TransitionCallbackReturn.SUCCESS:
                    return 1
        # What is there now stays: without it every full collection of garbage would hold an image up by 20 ms and more.
        gc.collect()
        gc.freeze()
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except Exception:
        # A signal ends the context at once, also under a message that is just being published.
        if rclpy.ok():
            raise
    finally:
        if node is not None:
            node.save_at_end()
            node.end_watch()
        rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
