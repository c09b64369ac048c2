# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Files of runs, which equal those of the program, and their reports."""

from __future__ import annotations

import base64
import dataclasses
import json
import os
import pickle
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import posemix as px
import pytest

CONFIGS = Path(__file__).parents[2] / "configs"


def program() -> str:
    path = os.environ.get("POSEMIX_PROGRAM")
    if not path:
        pytest.skip("POSEMIX_PROGRAM, the path of the program, is not set")
    return path


def data() -> Path:
    path = Path(os.environ.get("POSEMIX_DATA", "data"))
    if not (path / "experiments").is_dir():
        pytest.skip(f"no recordings in {path}; POSEMIX_DATA names the folder")
    return path


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A simulated recording as files."""
    folder = tmp_path_factory.mktemp("simulated") / "recording"
    file = px.read_simulation(CONFIGS / "demo.toml", ["camera.frames=210"])
    px.write_simulation(folder, file, px.simulate(file.config, seed=1), seed=1)
    return folder


@pytest.fixture(scope="module")
def plain_recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same without settings of the filter."""
    folder = tmp_path_factory.mktemp("simulated") / "plain"
    file = px.read_simulation(CONFIGS / "demo.toml", ["camera.frames=210"])
    file = dataclasses.replace(file, filter=[])
    px.write_simulation(folder, file, px.simulate(file.config, seed=2), seed=2)
    return folder


def without_timing(value: Any) -> Any:
    """Without times, and where the results come from: a program has a command line."""
    if isinstance(value, dict):
        left_out = ("_us", "timing", "provenance")
        return {k: without_timing(v) for k, v in value.items() if not any(part in k for part in left_out)}
    return [without_timing(v) for v in value] if isinstance(value, list) else value


def assert_same_results(a: Path, b: Path) -> None:
    names = sorted(p.name for p in a.iterdir())
    assert names == sorted(p.name for p in b.iterdir()) and "camera.tum" in names
    for name in names:
        if name.endswith(".tum"):
            assert (a / name).read_bytes() == (b / name).read_bytes(), name
        elif name.endswith(".json"):
            ours, theirs = (without_timing(json.loads((p / name).read_text())) for p in (a, b))
            assert ours == theirs, name


@pytest.mark.parametrize(
    "overrides",
    [[], ["filter.smooth=full"], ["filter.method=gm-iekf"], ["filter.method=riekf"], ["filter.method=rbpf"]],
    ids=["default", "smoothed", "gm-iekf", "riekf", "particles"],
)
def test_a_job_gives_what_the_program_gives(
    plain_recording: Path, tmp_path: Path, overrides: list[str]
) -> None:
    job = px.read_slam_job(plain_recording / "sequence.toml", overrides=overrides)
    run = px.run(job)
    px.write_results(tmp_path / "python", job, run)
    sets = [word for override in overrides for word in ("--set", override)]
    command = [program(), "slam", plain_recording / "sequence.toml", *sets, "--quiet", "--out", tmp_path / "cpp"]
    subprocess.run([str(word) for word in command], check=True)
    assert_same_results(tmp_path / "cpp", tmp_path / "python")


def test_a_simulation_gives_what_the_program_gives(recording: Path, tmp_path: Path) -> None:
    short = ["--set", "camera.frames=210", "--seed", "1", "--quiet"]
    command = [program(), "simulate", str(CONFIGS / "demo.toml"), *short, "--out", str(tmp_path / "cpp")]
    subprocess.run(command, check=True)
    for file in sorted((tmp_path / "cpp").iterdir()):
        assert file.read_bytes() == (recording / file.name).read_bytes(), file.name


def test_recorded_data_gives_what_the_program_gives(tmp_path: Path) -> None:
    folder = data()
    config = CONFIGS / "ycbv-0022.toml"
    job = px.read_slam_job(config, data=folder)
    run = px.run(job)
    metrics = px.evaluate(job, run)
    command = [program(), "slam", config, "--data", folder, "--quiet", "--json", "--out", tmp_path / "cpp"]
    subprocess.run([str(word) for word in command], check=True, stdout=subprocess.DEVNULL)
    theirs = json.loads((tmp_path / "cpp" / "metrics.json").read_text())
    assert metrics.frames == theirs["frames"] == len(run)
    trajectory = px.read_tum(tmp_path / "cpp" / "camera.tum")
    assert trajectory.poses.is_approx(run.camera.poses, 1e-9)
    posterior = px.read_posterior(tmp_path / "cpp" / "posterior.json")
    assert posterior.mixture == run.posterior
    assert [p.name for p in posterior.poses][0] == "camera"


def test_a_job_is_open(recording: Path) -> None:
    job = px.read_slam_job(recording / "sequence.toml", overrides=["output.trace_hypotheses=0"])
    assert repr(job.sequence).startswith("<Sequence of 210 frames")
    whole = px.run(pickle.loads(pickle.dumps(job)))
    parts = px.run(job.sequence, job.camera_prior, job.models, job.settings)
    assert whole.posterior == parts.posterior
    assert whole[-1].alternatives == {}
    settings = px.ObjectSlamSettings(motion=job.settings.motion, tracker=px.GaussianSumSettings())
    other = px.run(dataclasses.replace(job, settings=settings))
    assert other.posterior != whole.posterior
    assert len(px.run(job, progress=lambda done, total: done < 5)) == 5


def test_a_key_of_an_earlier_release_warns(recording: Path) -> None:
    with pytest.warns(FutureWarning, match="key 'filter.camera_share' has no effect any more"):
        px.read_slam_job(recording / "sequence.toml", overrides=["filter.camera_share=0.25"])


def test_what_is_assumed_of_a_noise_warns(recording: Path) -> None:
    model = 'noise.mug={components=[{rotation_sd_deg=2, translation_sd_m=0.01}]}'
    with pytest.warns(FutureWarning) as caught:
        job = px.read_slam_job(recording / "sequence.toml", overrides=[model, "objects.0.noise=mug"])
    text = "\n".join(str(warning.message) for warning in caught)
    assert "key 'noise.mug.slow' is missing" in text
    assert "key 'noise.mug.clutter' is missing" in text
    noise = job.models[0].noise
    np.testing.assert_allclose(noise.dependence.slow.covariance, 3 * noise.components[0].covariance)
    assert noise.dependence.slow.correlation_angle_rad == pytest.approx(np.pi / 2)


def payload_of(page: Path) -> Any:
    text = page.read_text()
    start = text.index('id="posemix-report">') + len('id="posemix-report">')
    return json.loads(text[start : text.index("</script>", start)])


def test_a_report_holds_the_run(recording: Path, tmp_path: Path) -> None:
    job = px.read_slam_job(recording / "sequence.toml")
    px.write_results(tmp_path / "out", job, px.run(job))
    page = px.write_report(tmp_path / "out", title="A table & its <objects>")
    assert page == tmp_path / "out" / "report.html"
    shown = payload_of(page)
    assert shown["kind"] == "slam" and shown["title"] == "A table & its <objects>"
    assert shown["trace"]["frames"] == len(job.sequence)
    metrics = json.loads((tmp_path / "out" / "metrics.json").read_text())
    assert shown["documents"]["metrics.json"] == metrics
    with pytest.raises(ValueError, match="nobody"):
        px.write_report(tmp_path / "out", meshes={"nobody": (tmp_path / "mesh.ply", 1e-3)})
    with pytest.raises(ValueError, match="empty"):
        (tmp_path / "empty").mkdir()
        px.write_report(tmp_path / "empty")


def test_a_report_has_the_camera_and_its_images(recording: Path, tmp_path: Path) -> None:
    job = px.read_slam_job(recording / "sequence.toml")
    px.write_results(tmp_path / "out", job, px.run(job))
    (tmp_path / "images").mkdir()
    picture = b"\x89PNG\r\n\x1a\n a picture"
    for k in range(3):
        (tmp_path / "images" / f"{k}.5.png").write_bytes(picture)
    page = px.write_report(tmp_path / "out", camera=(600, 601, 320, 240, 640, 480), images=tmp_path / "images")
    shown = payload_of(page)
    assert shown["trace"]["intrinsics"] == {"fx": 600, "fy": 601, "cx": 320, "cy": 240, "width": 640, "height": 480}
    assert [image["stamp_s"] for image in shown["images"]] == [0.5, 1.5, 2.5]
    assert base64.b64decode(shown["images"][0]["data"]) == picture
    with pytest.raises(ValueError, match="positive focal lengths"):
        px.write_report(tmp_path / "out", camera=(0, 601, 320, 240, 640, 480))


def test_a_report_warns_of_files_of_another_run(recording: Path, tmp_path: Path) -> None:
    job = px.read_slam_job(recording / "sequence.toml")
    px.write_results(tmp_path / "out", job, px.run(job))
    mixture = next((tmp_path / "out").glob("mixture_*.json"))
    px.write_mixture(mixture, px.Mixture([px.ConcentratedGaussian(px.SE3(), np.eye(6))]), "a", "b")
    with pytest.warns(UserWarning, match="is left out, as it is not of the run"):
        page = px.write_report(tmp_path / "out")
    assert mixture.name not in payload_of(page)["documents"]


def test_results_replace_those_of_another_run(recording: Path, tmp_path: Path) -> None:
    job = px.read_slam_job(recording / "sequence.toml")
    px.write_results(tmp_path / "out", job, px.run(job))
    (tmp_path / "out" / "notes.md").write_text("mine")
    assert list((tmp_path / "out").glob("mixture_*.json"))
    other = job.using("riekf")
    px.write_results(tmp_path / "out", other, px.run(other))
    assert not list((tmp_path / "out").glob("mixture_*.json"))
    assert (tmp_path / "out" / "notes.md").exists()


def test_runs_are_compared(recording: Path, tmp_path: Path) -> None:
    job = px.read_slam_job(recording / "sequence.toml")
    methods = ["riekf", "gm-iekf"]
    for method in methods:
        other = job.using(method)
        px.write_results(tmp_path / method, other, px.run(other))
    page = px.write_comparison([tmp_path / method for method in methods], title="Two filters")
    assert page == tmp_path / "comparison.html"
    shown = payload_of(page)
    assert shown["kind"] == "comparison" and shown["title"] == "Two filters"
    assert [run["name"] for run in shown["runs"]] == methods
    by_name = payload_of(px.write_report(tmp_path))["runs"]
    assert by_name == sorted(shown["runs"], key=lambda run: str(run["name"]))
    with pytest.raises(ValueError, match="at least two"):
        px.write_comparison([tmp_path / "riekf"], tmp_path / "x.html")


def test_errors_name_the_file(recording: Path, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="missing.toml"):
        px.read_slam_job(tmp_path / "missing.toml")
    with pytest.raises(ValueError, match="--set filter.methd=x"):
        px.read_slam_job(recording / "sequence.toml", overrides=["filter.methd=x"])
    bad = tmp_path / "bad.tum"
    bad.write_text("0 1 2 3 0 0 0 1\n1 1 2 x 0 0 0 1\n")
    with pytest.raises(ValueError, match="bad.tum:2:"):
        px.read_tum(bad)
    job = px.read_slam_job(recording / "sequence.toml")
    with pytest.raises(OSError, match="bad.tum"):
        px.write_results(bad, job, px.run(job))
