# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""A running estimator in Rerun."""

from __future__ import annotations

import os
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from posemix._core import ObjectEstimate
from posemix.density import ConcentratedGaussian
from posemix.lie import SE3
from posemix.live_view.addresses import require_free, require_listening, split_address, wait_until_free
from posemix.live_view.frames import Frustum, LiveFrame
from posemix.live_view.tables import health_text, label_of, state_table
from posemix.live_view.view import PacedView, Way
from posemix.plot.style import TRUTH_COLOUR, colour_of
from posemix.rerun import shapes
from posemix.rerun.runs import log_health

__all__ = ["RerunView"]

Up = Literal["x", "y", "z", "-x", "-y", "-z"]

_ANY_HOST = ("", "0.0.0.0")
# Times from here on are dates.
_DATES_S = 1e9
# Time between looks whether the viewer is there [s].
_LOOK_S = 0.1


class RerunView(PacedView):
    """Shows a running estimator in Rerun: `pip install posemix[rerun]`.

    Below the entity `world` are `camera` and every object by its id: `pose` (the leading one), `axes` and `ellipsoids`
    of all hypotheses, as opaque as they are probable, and the `way` of what moves. `existence/ID`,
    `mode_probability/ID` and `motion_models/ID/NAME` are numbers over time, `health` is a log of its changes, and
    `state` a table of all objects in words. The viewer gets an arrangement of its windows, too.

    Parameters
    ----------
    address : str, optional
        ":9876" (the default): viewers connect to this program, on all network interfaces, with ``rerun
        rerun+http://HOST:9876/proxy``. "rerun+http://HOST:PORT/proxy": a viewer that listens there.
    file : path, optional
        An .rrd file to write, in place of an address.
    recording : RecordingStream, optional
        A recording stream of Rerun that has its own place to log to, in place of both.
    rate_hz : float
        Frames per second of the estimates' time that are shown at most.
    world : str
        Entity of the world.
    frustum : Frustum, optional
        What the camera sees.
    up : {"x", "y", "z", "-x", "-y", "-z"}, optional
        Axis of the world that is drawn upwards.
    model_names : mapping of str to sequence of str, optional
        Names of the models of motion by the object's id; by default "0", "1", ...
    trail_s : float
        Length of the way of an object that moves [s]; that of the camera is shown as a whole.
    memory_limit : str
        Memory that data for viewers that connect late may take; of more the oldest are dropped.

    Raises
    ------
    ImportError
        Without the package rerun-sdk.
    OSError
        If the port is in use, no viewer listens at the address, or the file cannot be written.
    ValueError
        For an address that is none.
    """

    def __init__(
        self,
        address: str | None = None,
        *,
        file: str | os.PathLike[str] | None = None,
        recording: Any = None,
        rate_hz: float = 10.0,
        world: str = "world",
        frustum: Frustum | None = None,
        up: Up | None = None,
        model_names: Mapping[str, Sequence[str]] | None = None,
        trail_s: float = 5.0,
        memory_limit: str = "256MB",
    ) -> None:
        super().__init__(rate_hz)
        if sum(place is not None for place in (address, file, recording)) > 1:
            raise ValueError("expected one of address, file and recording")
        if up is not None and up.lstrip("-") not in ("x", "y", "z"):
            raise ValueError(f"up is '{up}'; expected x, y or z, or one of them with a minus")
        self._rr = shapes.viewer()
        self._world, self._model_names, self._trail_s = world, model_names or {}, trail_s
        self._is_own = recording is None
        self._port: int | None = None
        self._viewer: str | None = None
        self._is_gone, self._next_look_s = False, 0.0
        self._recording = recording or self._opened(address or ":9876", file, memory_limit)
        self._forget()
        self._log_static(frustum, up)

    def _opened(self, address: str, file: str | os.PathLike[str] | None, memory_limit: str) -> Any:
        recording = self._rr.RecordingStream("posemix")
        layout = self._layout()
        if file is not None:
            # Rerun itself would only log that it cannot.
            Path(file).open("wb").close()
            recording.save(os.fspath(file), default_blueprint=layout)
        elif "://" in address:
            require_listening(address, "a viewer of Rerun (start one with: rerun)")
            self._viewer = address
            recording.connect_grpc(address, default_blueprint=layout)
        else:
            host, port = split_address(address)
            if host not in _ANY_HOST:
                raise ValueError(
                    f"address is '{address}'; expected :PORT, as Rerun serves on all network interfaces, or "
                    "rerun+http://HOST:PORT/proxy of a viewer that listens"
                )
            require_free("0.0.0.0", port)
            self._port = port
            recording.serve_grpc(grpc_port=port, default_blueprint=layout, server_memory_limit=memory_limit)
        return recording

    def _layout(self) -> Any:
        bp = self._rr.blueprint
        shares = bp.ScalarAxis(range=(0.0, 1.0))
        plots = [
            bp.TimeSeriesView(origin=what, name=title, axis_y=shares, plot_legend=bp.Corner2D.RightBottom)
            for what, title in (("existence", "Existence"), ("mode_probability", "On the right mode"))
        ]
        state = bp.TextDocumentView(origin="state", name="Objects")
        columns = bp.TextLogColumns(text_log_columns=["LogLevel", "Body"])
        log = bp.TextLogView(origin="health", name="Health", columns=columns)
        space = bp.Spatial3DView(origin=self._world, name="World", background=[250, 250, 250])
        side = bp.Vertical(state, *plots, log, row_shares=[3, 2, 2, 2])
        return bp.Blueprint(bp.Horizontal(space, side, column_shares=[3, 2]), collapse_panels=True)

    def _forget(self) -> None:
        self._healths: dict[str, str] = {}
        self._ways = {"camera": Way()}

    def _log(self, path: str, *what: Any, static: bool = False) -> None:
        self._rr.log(f"{self._world}/{path}" if path else self._world, *what, static=static, recording=self._recording)

    def _part(self, name: str) -> str:
        """An object's name, which may be any text, as a part of a path."""
        return str(self._rr.escape_entity_path_part(name))

    def _log_static(self, frustum: Frustum | None, up: Up | None) -> None:
        rr = self._rr
        if up is not None:
            axis = getattr(rr.ViewCoordinates, f"RIGHT_HAND_{up[-1].upper()}_{'DOWN' if up[0] == '-' else 'UP'}")
            self._log("", axis, static=True)
        if frustum is not None:
            f = frustum
            pinhole = rr.Pinhole(
                focal_length=[f.fx, f.fy], principal_point=[f.cx, f.cy], resolution=[f.width, f.height],
                image_plane_distance=f.depth_m,
            )  # fmt: skip
            self._log("camera/pose/image", pinhole, static=True)

    def _is_heard(self) -> bool:
        """Whether the viewer is still there: to one that has gone away Rerun would wait to send."""
        if self._viewer is None or time.monotonic() < self._next_look_s:
            return not self._is_gone
        try:
            require_listening(self._viewer, "the viewer", timeout_s=0.2)
            self._is_gone = False
        except OSError:
            self._is_gone = True
        self._next_look_s = time.monotonic() + _LOOK_S
        return not self._is_gone

    def _show(self, frame: LiveFrame) -> None:
        if not self._is_heard():
            return
        self._set_time(frame.stamp_s)
        camera = frame.estimate.camera
        self._show_pose("camera", camera)
        self._show_way("camera", frame.stamp_s, camera.mean)
        for name in set(self._healths) - set(frame.names):
            self._log(self._part(name), self._rr.Clear(recursive=True))
            self._healths.pop(name)
            self._ways.pop(name, None)
        for index, name in enumerate(frame.estimate.ids):
            if name in frame.names:
                self._show_object(name, frame, colour_of(index))
        table = self._rr.TextDocument(state_table(frame), media_type="text/markdown")
        self._rr.log("state", table, recording=self._recording)

    def _set_time(self, stamp_s: float) -> None:
        if stamp_s < _DATES_S:
            shapes.set_time(stamp_s, recording=self._recording)
        else:
            self._rr.set_time("date", timestamp=stamp_s, recording=self._recording)

    def _show_pose(self, name: str, density: ConcentratedGaussian[SE3]) -> None:
        shapes.log_pose(f"{self._world}/{name}/pose", density.mean, recording=self._recording)
        shapes.log_ellipsoid(
            f"{self._world}/{name}/ellipsoid", density, colour=TRUTH_COLOUR, recording=self._recording
        )

    def _show_way(self, name: str, stamp_s: float, pose: SE3, colour: str = "#444444") -> None:
        trail = None if name == "camera" else self._trail_s
        way = self._ways.setdefault(name, Way(trail_s=trail))
        way.add(stamp_s, pose.translation)
        if way.is_due(stamp_s):
            strip = self._rr.LineStrips3D([way.positions], colors=[shapes.rgba(colour, 1.0)])
            self._log(f"{self._part(name)}/way", strip)

    def _show_object(self, name: str, frame: LiveFrame, colour: str) -> None:
        path, of_object = f"{self._world}/{self._part(name)}", frame.estimate.object(name)
        assert of_object.world is not None
        # The axes are those of the leading hypothesis.
        shapes.log_pose(f"{path}/pose", of_object.world.mean, axis_length=0.0, recording=self._recording)
        label = label_of(name, of_object)
        shapes.log_hypotheses(path, frame.mixture(name), colour=colour, name=label, recording=self._recording)
        self._log_numbers(name, of_object, colour)
        health = health_text(of_object)
        if health != self._healths.get(name):
            log_health("health", of_object.health, f"{name}: {health}", recording=self._recording)
            self._healths[name] = health
        if of_object.motion_models:
            self._show_way(name, frame.stamp_s, of_object.world.mean, colour)

    def _log_numbers(self, name: str, of_object: ObjectEstimate, colour: str) -> None:
        if name not in self._healths:
            line = self._rr.SeriesLines(colors=[shapes.rgba(colour, 1.0)], names=[name])
            for plot in ("existence", "mode_probability"):
                self._rr.log(f"{plot}/{self._part(name)}", line, static=True, recording=self._recording)
        models = list(map(float, of_object.motion_models))
        names = self._model_names.get(name) or [str(i) for i in range(len(models))]
        part = self._part(name)
        shares = {f"existence/{part}": of_object.existence, f"mode_probability/{part}": of_object.mode_probability}
        shares.update({f"motion_models/{part}/{n}": p for n, p in zip(names, models, strict=True)})
        known = {path: share for path, share in shares.items() if share is not None}
        shapes.log_scalars("", known, recording=self._recording)

    def _clear(self) -> None:
        for name in ("camera", *self._healths):
            self._log(self._part(name), self._rr.Clear(recursive=True))
        self._forget()

    def close(self) -> None:
        """Hands over what was not yet sent, and lets go of the port or the file."""
        if self._recording is not None and self._is_own:
            try:
                if self._is_heard():
                    self._recording.flush(timeout_sec=5.0)
            except Exception:  # of a viewer that goes away just now
                self._is_gone = True
            self._recording.disconnect()
            if self._port is not None:
                wait_until_free("0.0.0.0", self._port)
        self._recording = None
