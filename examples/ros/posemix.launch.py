# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Starts posemix-ros with the parameters beside this file.

    ros2 launch posemix.launch.py [params_file:=FILE] [bag:=BAG]

With a bag, it is played with its clock, and the node follows that.
"""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PythonExpression


def generate_launch_description() -> LaunchDescription:
    """The node, and a player where a bag is given."""
    bag, params = LaunchConfiguration("bag"), LaunchConfiguration("params_file")
    has_bag = PythonExpression(["'", bag, "' != ''"])
    return LaunchDescription(
        [
            DeclareLaunchArgument("params_file", default_value=str(Path(__file__).parent / "posemix.yaml")),
            DeclareLaunchArgument("bag", default_value=""),
            ExecuteProcess(
                cmd=["posemix-ros", "--ros-args", "--params-file", params, "-p", ["use_sim_time:=", has_bag]],
                output="screen",
            ),
            ExecuteProcess(
                cmd=["ros2", "bag", "play", bag, "--clock"], output="screen", condition=IfCondition(has_bag)
            ),
        ]
    )
