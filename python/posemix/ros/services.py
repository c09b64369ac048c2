# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The node's services, all of std_srvs/Trigger: what they need besides is in parameters that may be set at any time."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

from posemix.ros.configuration import names
from posemix.ros.engine import Engine
from posemix.ros.estimates import LiveEstimate

__all__ = ["Services"]


class Services:
    """Offers reset, save, load and forget.

    Parameters
    ----------
    node : Node
        The node of rclpy.
    engine : Engine
        What they change.
    changed : callable
        Is called with the estimate after a change, None where there is none.
    """

    def __init__(self, node: Any, engine: Engine, changed: Callable[[LiveEstimate | None], None]) -> None:
        self._node, self._engine, self._changed = node, engine, changed
        trigger = import_module("std_srvs.srv").Trigger
        offered = {"reset": self._reset, "save": self._save, "load": self._load, "forget": self._forget}
        self._services = [node.create_service(trigger, f"~/{name}", self._answer(of)) for name, of in offered.items()]

    def destroy(self) -> None:
        """Offers them no more."""
        for service in self._services:
            self._node.destroy_service(service)

    def _answer(self, of: Callable[[], str]) -> Callable[[Any, Any], Any]:
        def answer(request: Any, response: Any) -> Any:
            try:
                response.success, response.message = True, of()
            except (ValueError, OSError) as error:
                response.success, response.message = False, str(error)
            return response

        return answer

    def _path(self) -> str:
        path = self._node.get_parameter("map_file").value
        if not path:
            raise ValueError("the parameter map_file is empty, expected the path of a file")
        return str(path)

    def _reset(self) -> str:
        self._engine.reset()
        self._changed(None)
        return "all objects are forgotten"

    def _save(self) -> str:
        path = self._path()
        self._engine.save(path)
        return f"saved in {path}"

    def _load(self) -> str:
        return self._engine.load(self._path(), go_on=self._node.get_parameter("map_goes_on").value)

    def _forget(self) -> str:
        given = names(self._node.get_parameter("forget_ids").value)
        if not given:
            raise ValueError("the parameter forget_ids is empty, expected names of objects")
        self._changed(self._engine.forget(given))
        return f"forgotten: {', '.join(given)}"
