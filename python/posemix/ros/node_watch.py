# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""A node with a live view and a report."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

from rclpy.task import Future

from posemix.ros.estimates import LiveEstimate
from posemix.ros.node_base import NodeBase
from posemix.ros.watching import Watch

__all__ = ["WatchedNode"]


class WatchedNode(NodeBase):
    """Shows its estimates live, records them, and writes reports, by its parameters."""

    _watch: Watch | None = None

    def _begin_watch(self, values: Mapping[str, Any]) -> None:
        """Opens view and recording; raises ValueError, OSError or ImportError as `Watch`."""
        self._watch = Watch(values, self.get_name())
        trigger = import_module("std_srvs.srv").Trigger
        self._report_service = self.create_service(trigger, "~/report", self._report)

    def _show_live(self, estimate: LiveEstimate) -> None:
        if self._watch is not None:
            self._watch.show(estimate)
            for problem in self._watch.problems:
                self._complain(problem)

    async def _report(self, request: Any, response: Any) -> Any:
        """Answers when the report is written; what comes until then is taken in meanwhile."""
        if self._watch is None:
            response.success, response.message = False, "the node is not configured"
            return response
        written = Future(executor=self.executor)
        self._watch.report_meanwhile(written.set_result)
        response.success, response.message = await written
        return response

    def _report_at_end(self) -> None:
        done = None if self._watch is None else self._watch.report_at_end()
        if done is not None and done[0]:
            self.get_logger().info(f"report: {done[1]}")
        elif done is not None:
            self.get_logger().error(f"no report could be written: {done[1]}")

    def on_deactivate(self, state: Any) -> Any:
        """Writes the report, where one is wanted."""
        self._report_at_end()
        return super().on_deactivate(state)

    def end_watch(self) -> None:
        """Writes the report of the run, where one is wanted, and closes the live view."""
        if self._watch is not None:
            self._report_at_end()
            self._watch.close()
            self.destroy_service(self._report_service)
            self._watch = None
