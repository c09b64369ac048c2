# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Everything public is called with numbers that are none, shapes that do not fit, indices that nothing has, and objects
of other types: each call is refused by an error with a message, or does its work; none ends the process or hangs."""

from __future__ import annotations

import json
import os
import re
import signal
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path

import hostile
import pytest
from public_calls import ALL, Callee

# What reads files is fed by the fuzz targets, and what needs other packages by its own tests.
ELSEWHERE = re.compile(
    r"^posemix\.(bags|interop|plot|rerun|live_view|ros|recording|density|divergence|em|fiducials|filter|grasp|io|lie|mixture|"
    r"noise|operations|random|runs|slam)\.|^posemix\.(read_|write_)"
)
# No call of these is made up by rule; their own tests have them.
NOT_CALLED: set[str] = {
    "Fiducials.__init__", "FixedLagSmoother.step", "GaussianSumFilter.predict", "ObjectBox.corners",
    "ObjectSlam.from_bytes", "ObjectSlam.load", "OdometryNoise.to_toml", "PosteriorFile.__init__",
    "PosteriorFile.replace", "StampedSlam.add_frame", "StampedSlam.from_bytes", "StampedSlam.load",
    "bootstrap_regions", "find_slam_method", "fit_existence", "models_with_priors", "observe_fiducials", "run",
    "run_smoothed",
}  # fmt: skip
# Numbers that are none are taken here, and why.
NAN_IS_FINE: dict[str, list[str]] = {
    "Arithmetic of elements, whose missing poses are NaN (with_misses).": [
        "SE3.ad", "SE3.exp", "SE3.left_jacobian", "SE3.left_jacobian_inverse", "SE3.right_jacobian",
        "SE3.right_jacobian_inverse", "SO3.ad", "SO3.exp", "SO3.left_jacobian", "SO3.left_jacobian_inverse",
        "SO3.right_jacobian", "SO3.right_jacobian_inverse",
    ],
    "Evaluated by rows: that of a NaN is NaN.": [
        "CameraModel.project", "CameraModel.rays", "ErrorMixture.log_density", "ErrorMixture.log_pose_density",
        "LogisticModel.probability",
    ],
    "Plain data in, plain data out; it is checked by who computes with it.": [
        "SlamMethod.settings", "along_camera", "calm_and_agile", "camera_on_arm", "claimed_clutter",
        "claimed_mode_time_s", "claimed_noise", "claimed_slow_error", "object_model",
    ],
    "A tolerance that is never reached, or always.": [
        "SE3.from_matrix", "SE3.is_approx", "SO3.from_matrix", "SO3.is_approx", "fuse", "fuse_arrays", "merge",
        "moments",
    ],
    "The weight and the length of runs are not looked at.": [
        "associate",
    ],
    "A group of one element looks at nothing.": [
        "SymmetryGroup.closest", "SymmetryGroup.closest_observed",
    ],
}  # fmt: skip
SECONDS = 60
CALLEES = [callee for callee in ALL if not ELSEWHERE.match(callee.path)]


def attack(callees: Sequence[Callee], out: int) -> None:
    """In a process of its own: a line of JSON before every call and after it."""
    with os.fdopen(out, "w", buffering=1) as lines:
        for callee in callees:
            signal.alarm(SECONDS)
            count = 0
            for word, call, must in hostile.attacks(callee):
                lines.write(json.dumps(["begin", word]) + "\n")
                lines.write(json.dumps(["end", hostile.judge(call, must)]) + "\n")
                count += 1
            lines.write(json.dumps(["called", callee.path, count]) + "\n")


def attacked(callees: Sequence[Callee]) -> tuple[list[str], set[str]]:
    """What went wrong, and what could not be called."""
    wrong, uncalled, left = [], set(), list(callees)
    while left:
        read, write = os.pipe()
        child = os.fork()
        if child == 0:
            os.close(read)
            try:
                attack(left, write)
            except BaseException:
                traceback.print_exc()
                os._exit(1)
            os._exit(0)
        os.close(write)
        begun = ""
        with os.fdopen(read) as lines:
            for line in lines:
                what, word, *more = json.loads(line)
                if what == "begin":
                    begun = word
                elif what == "called":
                    left = left[1:]
                    if not more[0]:
                        uncalled.add(word)
                elif word:
                    wrong.append(f"{begun}: {word}")
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        if status:
            wrong.append(f"{begun}: ends the process, {status}")
            left = left[1:]
    return wrong, uncalled


@pytest.mark.skipif(not hasattr(os, "fork") or sys.platform != "linux", reason="needs fork")
def test_hostile_arguments_are_refused_or_do_their_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    wrong, uncalled = attacked(CALLEES)
    taken = {line.split("(")[0].removeprefix("posemix.") for line in wrong if line.endswith(": is taken")}
    others = [line for line in wrong if not line.endswith(": is taken")]
    assert not others, "\n".join(others)
    assert taken == {name for names in NAN_IS_FINE.values() for name in names}
    assert {path.removeprefix("posemix.") for path in uncalled} == NOT_CALLED
