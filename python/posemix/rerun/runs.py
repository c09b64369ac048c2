# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Logs runs of object SLAM to Rerun: paths, existence and health of objects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from posemix._core import SlamRun, TrackHealth
from posemix.plot.style import PALETTE
from posemix.rerun.shapes import log_scalars, log_tracking, set_time, viewer

__all__ = ["log_health", "log_run", "log_state"]


def log_state(
    path: str,
    health: TrackHealth,
    existence: float | None = None,
    motion_models: Mapping[str, float] | None = None,
    *,
    before: TrackHealth | None = None,
    recording: Any = None,
) -> None:
    """Logs the state of a track: PATH/health as a text, PATH/existence and PATH/motion_models/NAME as numbers.

    Parameters
    ----------
    path : str
        Entity of the object.
    health : TrackHealth
        State of the track; a warning in the log where it is lost or inconsistent.
    existence : float, optional
        Probability that the object exists.
    motion_models : mapping of str to float, optional
        Probabilities of the models of motion by name.
    before : TrackHealth, optional
        State before; the text is logged where it has changed.
    recording : RecordingStream, optional
        Rerun's recording stream; by default the current one.
    """
    if health != before:
        log_health(f"{path}/health", health, health.name, recording=recording)
    if existence is not None:
        log_scalars(path, {"existence": existence}, recording=recording)
    log_scalars(f"{path}/motion_models", motion_models or {}, recording=recording)


def log_health(path: str, health: TrackHealth, text: str, *, recording: Any = None) -> None:
    """Logs a text to PATH, a warning where the health is that of a track that is lost or inconsistent."""
    rr = viewer()
    bad = health in (TrackHealth.lost, TrackHealth.inconsistent)
    rr.log(path, rr.TextLog(text, level="WARN" if bad else "INFO"), recording=recording)


def log_run(
    path: str,
    run: SlamRun,
    *,
    model_names: Mapping[str, Sequence[str]] | None = None,
    trail_s: float = 5.0,
    recording: Any = None,
) -> None:
    """Logs a run of object SLAM: PATH/camera and PATH/ID of every object as `log_tracking`, with the state of tracks.

    Objects that move have a trail; objects that were never seen are left out.

    Parameters
    ----------
    path : str
        Entity of the world.
    run : SlamRun
        The run.
    model_names : mapping of str to sequence of str, optional
        Names of the models of motion by the object's id; by default "0", "1", ...
    trail_s : float
        Length of the trail of an object that moves [s].
    recording : RecordingStream, optional
        Rerun's recording stream; by default the current one.
    """
    log_tracking(f"{path}/camera", run.stamps, run.camera.poses, run.camera.covariances, recording=recording)
    for k, name in enumerate(run.ids):
        track, models = run.object(name), run.motion_models(name)
        if not track.known.any():
            continue
        colour = PALETTE[k % len(PALETTE)]
        trail = trail_s if models.shape[1] else None
        log_tracking(
            f"{path}/{name}", run.stamps, track.poses, track.covariances,
            colour=colour, trail_s=trail, recording=recording,
        )  # fmt: skip
        if all(health == TrackHealth.none for health in run.healths(name)):
            continue
        names = (model_names or {}).get(name) or [str(i) for i in range(models.shape[1])]
        before = None
        for stamp, health, existence, row in zip(
            run.stamps, run.healths(name), run.existences(name), models, strict=True
        ):
            set_time(float(stamp), recording=recording)
            log_state(
                f"{path}/{name}", health, float(existence), dict(zip(names, map(float, row), strict=True)),
                before=before, recording=recording,
            )  # fmt: skip
            before = health
