# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Files that earlier versions wrote are read (docs/compatibility.md).

`tests/samples/VERSION` has what the program of that version made of its `simulation.toml`, and is never written anew.
"""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import posemix as px
import pytest

SAMPLES = Path(__file__).resolve().parents[2] / "tests/samples"
VERSIONS = sorted(path.name for path in SAMPLES.iterdir() if path.is_dir())


@pytest.fixture(params=VERSIONS)
def sample(request: pytest.FixtureRequest) -> Path:
    return SAMPLES / str(request.param)


def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    program = os.environ.get("POSEMIX_PROGRAM")
    if program is None:
        pytest.skip("POSEMIX_PROGRAM, the path of the program, is not set")
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done


def loaded(path: Path) -> Any:
    return json.loads(path.read_text())


def test_there_are_samples_of_every_version_that_was_released() -> None:
    assert VERSIONS == ["0.1", "0.2"]


def test_a_sequence_file_is_run_and_tells_of_the_same_frames_and_objects(sample: Path, tmp_path: Path) -> None:
    for sequence in sample.glob("*/sequence.toml"):
        run("slam", sequence, "--out", tmp_path / sequence.parent.name, "--quiet")
        metrics, before = loaded(tmp_path / sequence.parent.name / "metrics.json"), loaded(sample / "run/metrics.json")
        assert (metrics["frames"], list(metrics["objects"])) == (before["frames"], list(before["objects"]))
        for name, numbers in before["objects"].items():
            assert metrics["objects"][name]["detections"] == numbers["detections"], name


def test_a_simulation_is_run(sample: Path, tmp_path: Path) -> None:
    run("simulate", sample / "simulation.toml", "--seed", "1", "--out", tmp_path / "out", "--quiet")
    assert (tmp_path / "out/sequence.toml").exists()


def test_a_mixture_file_is_read_to_the_last_bit(sample: Path) -> None:
    files = [path for path in [*sample.glob("run/mixture_*.json"), *sample.glob("*.json")] if path.name != "study.json"]
    assert files
    for path in files:
        written, read = loaded(path), px.read_mixture(path)
        assert len(read.mixture) == len(written["components"])
        for component, numbers in zip(read.mixture, written["components"], strict=True):
            np.testing.assert_array_equal(component.covariance, numbers["covariance"])
        weights = [np.exp(component["log_weight"]) for component in written["components"]]
        np.testing.assert_allclose(read.mixture.weights, weights, rtol=1e-15)


def test_a_posterior_is_read_to_the_last_bit(sample: Path) -> None:
    for path in sample.glob("*run/posterior.json"):
        written, read = loaded(path), px.read_posterior(path)
        assert [pose.name for pose in read.poses] == [pose["name"] for pose in written["poses"]]
        for component, numbers in zip(read.mixture, written["components"], strict=True):
            np.testing.assert_array_equal(component.covariance, numbers["covariance"])


def test_results_become_a_page_with_no_complaint_but_on_old_names(sample: Path, tmp_path: Path) -> None:
    for folder in [path.parent for path in sample.glob("*/trace.json")]:
        done = run("report", folder, "--out", tmp_path / "page.html", "--quiet")
        assert [line for line in done.stderr.splitlines() if "the old name will be refused in" not in line] == []
        assert (tmp_path / "page.html").stat().st_size > 100_000


def test_errors_of_a_run_are_those_that_were_told(sample: Path, tmp_path: Path) -> None:
    run("consistency", sample / "run", "--out", tmp_path / "out", "--quiet")
    found = loaded(tmp_path / "out/consistency.json")
    told = loaded(sample / "run/metrics.json")["camera_consistency"]["anees"]
    # A trace has nine digits, of which the inverse of a covariance loses some.
    assert found["poses"][0]["pose"]["anees"] == pytest.approx(told, rel=1e-5)


def test_observations_are_read(sample: Path) -> None:
    for path in [*sample.glob("*/observations.jsonl"), *sample.glob("*/observations.csv")]:
        lines = [line for line in path.read_text().splitlines() if line[:1] in ("{", *"0123456789")]
        assert len(px.read_observations(path)) == len(lines)


def test_a_state_is_read_or_refused_by_its_version(sample: Path) -> None:
    """A state is read by the version of its format alone (docs/state.md)."""
    for path in sample.glob("*.state"):
        try:
            info = px.state_info(path)
        except ValueError as error:
            assert "version" in str(error)
        else:
            assert info.version.startswith(sample.name)
