# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""A running estimator in Foxglove."""

from __future__ import annotations

import os
import threading
from collections.abc import Mapping, Sequence
from typing import Any

from posemix._core import ObjectEstimate, TrackHealth
from posemix.lie import SE3
from posemix.live_view.addresses import require_free, split_address, wait_until_free
from posemix.live_view.foxglove_messages import STATE_SCHEMA, SceneMaker, foxglove, state_of
from posemix.live_view.frames import Frustum, LiveFrame
from posemix.live_view.tables import health_text, label_of
from posemix.live_view.view import PacedView, Way
from posemix.plot.style import colour_of

__all__ = ["FoxgloveView"]

_BAD = (TrackHealth.lost, TrackHealth.inconsistent)
_WAY = "#444444"
_STOP_S = 2.0
# Messages that wait for a slow viewer; of more the oldest are dropped.
_BACKLOG = 256


class FoxgloveView(PacedView):
    """Shows a running estimator in Foxglove, to which it is a WebSocket server: `pip install posemix[foxglove]`.

    The topics are `/posemix/tf` (the camera and the leading pose of every object in the world), `/posemix/scene` (axes
    and ellipsoids of all hypotheses, as opaque as they are probable, the frustum of the camera, the ways of what
    moves), `/posemix/objects/ID` (existence, probability of the mode, health and hypotheses of an object as JSON, for
    plots) and `/posemix/health` (a log of its changes). A topic to which nobody has subscribed costs nothing.

    Parameters
    ----------
    address : str, optional
        HOST:PORT at which viewers connect, "127.0.0.1:8765" unless given; ":8765" is the port on all network
        interfaces.
    file : path, optional
        An MCAP file to write, which must not exist, in place of an address.
    rate_hz : float
        Frames per second of the estimates' time that are shown at most.
    world_frame, camera_frame : str
        Names of the frames of the world and of the camera.
    frustum : Frustum, optional
        What the camera sees.
    model_names : mapping of str to sequence of str, optional
        Names of the models of motion by the object's id; by default "0", "1", ...
    trail_s : float
        Length of the way of an object that moves [s]; that of the camera is shown as a whole.

    Raises
    ------
    ImportError
        Without the package foxglove-sdk.
    OSError
        If the port is in use, or the file cannot be written.
    ValueError
        For an address that is none.
    """

    def __init__(
        self,
        address: str | None = None,
        *,
        file: str | os.PathLike[str] | None = None,
        rate_hz: float = 10.0,
        world_frame: str = "world",
        camera_frame: str = "camera",
        frustum: Frustum | None = None,
        model_names: Mapping[str, Sequence[str]] | None = None,
        trail_s: float = 5.0,
    ) -> None:
        super().__init__(rate_hz)
        if address is not None and file is not None:
            raise ValueError("expected one of address and file")
        self._fg = foxglove()
        self._make = SceneMaker(world_frame)
        self._camera, self._frustum, self._trail_s = camera_frame, frustum, trail_s
        self._model_names = model_names or {}
        self._context = self._fg.Context()
        self._server: Any = None
        self._writer: Any = None
        if file is not None:
            try:
                self._writer = self._fg.open_mcap(os.fspath(file), context=self._context)
            except OSError as error:
                raise type(error)(f"{os.fspath(file)}: cannot be written: {error}") from error
        else:
            self._serve(address or "127.0.0.1:8765")
        channels = foxglove("channels")
        self._tf = channels.FrameTransformsChannel("/posemix/tf", context=self._context)
        self._scene = channels.SceneUpdateChannel("/posemix/scene", context=self._context)
        self._health = channels.LogChannel("/posemix/health", context=self._context)
        self._states: dict[str, Any] = {}
        self._forget()

    def _serve(self, address: str) -> None:
        host, port = split_address(address)
        host = host or "0.0.0.0"
        require_free(host, port)
        self._address = (host, port)
        self._server = self._fg.start_server(
            name="posemix", host=host, port=port, context=self._context, message_backlog_size=_BACKLOG
        )

    def _forget(self) -> None:
        self._ways = {self._camera: Way()}
        self._healths: dict[str, str] = {}
        self._entities: set[str] = set()

    def _show(self, frame: LiveFrame) -> None:
        stamp_ns = round(frame.stamp_s * 1e9)
        self._make.begin(stamp_ns)
        worlds = frame.estimate.objects
        poses = {self._camera: frame.estimate.camera.mean}
        poses.update({name: world.mean for name, world in worlds.items() if world is not None})
        objects = {name: frame.estimate.object(name) for name in frame.names}
        for name, pose in poses.items():
            if name == self._camera or (name in objects and objects[name].motion_models):
                self._lengthen(name, frame.stamp_s, pose)
        if self._tf.has_sinks():
            self._tf.log(self._make.transforms(poses), log_time=stamp_ns)
        if self._scene.has_sinks():
            self._log_scene(frame, stamp_ns)
        for name, of_object in objects.items():
            self._log_state(name, of_object, frame, stamp_ns)
        for name in set(self._states) - set(objects):
            self._drop(name)

    def _lengthen(self, name: str, stamp_s: float, pose: SE3) -> None:
        trail = None if name == self._camera else self._trail_s
        self._ways.setdefault(name, Way(trail_s=trail)).add(stamp_s, pose.translation)

    def _log_scene(self, frame: LiveFrame, stamp_ns: int) -> None:
        colours = {name: colour_of(i) for i, name in enumerate(frame.estimate.ids)}
        entities = {}
        for name in frame.names:
            label = label_of(name, frame.estimate.object(name))
            made = self._make.hypotheses(name, label, frame.mixture(name), colours[name])
            entities[f"{name}/hypotheses"] = made
        for name, way in self._ways.items():
            if way.is_due(frame.stamp_s):
                entities[f"{name}/way"] = self._make.line(name, way.positions, colours.get(name, _WAY))
        if self._frustum is not None:
            entities[f"{self._camera}/frustum"] = self._make.frustum(self._camera, self._frustum)
        there = set(entities) | {f"{name}/way" for name in self._ways}
        gone = sorted(self._entities - there)
        self._scene.log(self._make.update(list(entities.values()), gone), log_time=stamp_ns)
        self._entities = there

    def _log_state(self, name: str, of_object: ObjectEstimate, frame: LiveFrame, stamp_ns: int) -> None:
        if name not in self._states:
            self._states[name] = self._fg.Channel(
                f"/posemix/objects/{name}", schema=STATE_SCHEMA, context=self._context
            )
        if self._states[name].has_sinks():
            models = [str(i) for i in range(len(of_object.motion_models))]
            named = self._model_names.get(name) or models
            self._states[name].log(state_of(of_object, frame.hypotheses[name], named), log_time=stamp_ns)
        health = health_text(of_object)
        if health != self._healths.get(name):
            self._healths[name] = health
            self._health.log(self._make.log(name, health, of_object.health in _BAD), log_time=stamp_ns)

    def _drop(self, name: str) -> None:
        """Lets go of the topic of an object that there is no more."""
        self._states.pop(name).close()
        self._healths.pop(name, None)
        self._ways.pop(name, None)

    def _clear(self) -> None:
        for name in list(self._states):
            self._drop(name)
        if self._entities and self._scene.has_sinks():
            stamp_ns = round(self._shown_s * 1e9)
            self._make.begin(stamp_ns)
            self._scene.log(self._make.update([], sorted(self._entities)), log_time=stamp_ns)
        self._forget()
        if self._server is not None:
            self._server.clear_session()

    @property
    def port(self) -> int | None:
        """The port at which viewers connect; None for a file."""
        return None if self._server is None else int(self._server.port)

    def close(self) -> None:
        """Lets go of the port, or ends the file."""
        if self._server is not None:
            # A viewer that does not read would be waited for.
            stop = threading.Thread(target=self._server.stop, name="posemix-foxglove-stop", daemon=True)
            stop.start()
            stop.join(_STOP_S)
            wait_until_free(*self._address)
        if self._writer is not None:
            self._writer.close()
        self._server = self._writer = None
