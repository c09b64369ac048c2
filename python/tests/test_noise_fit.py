# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The noise of a detector and of odometry, learned from arrays of poses."""

from __future__ import annotations

import numpy as np
import pytest

import posemix as px

SD = np.array([0.05, 0.05, 0.02, 0.01, 0.01, 0.03])


def poses(rng: np.random.Generator, count: int) -> px.SE3:
    """An object half a metre to a metre and a half before the camera, turned at random."""
    positions = np.column_stack([rng.uniform(-0.2, 0.2, (count, 2)), rng.uniform(0.5, 1.5, count)])
    return px.SE3(px.SO3.exp(rng.normal(size=(count, 3))), positions)


def test_noise_of_a_simulated_detector(rng: np.random.Generator) -> None:
    truth = poses(rng, 900)
    turned = rng.uniform(size=900) < 0.2
    mode = px.SE3(px.SO3.exp(np.where(turned[:, None], [0.0, np.pi / 2, 0.0], 0.0)))
    detected = truth * mode * px.SE3.exp(rng.normal(size=(900, 6)) * SD)
    recording = np.repeat(["a", "b", "c"], 300)
    settings = px.NoiseFitSettings(max_components=2, restarts=2)
    fit = px.fit_noise(truth, detected, recording=recording, settings=settings, seed=2)
    assert fit.frame == px.NoiseFrame.object
    assert [mode.accepted for mode in fit.modes] == [True]
    right, wrong, *rest = fit.noise.components
    assert sum(component.weight for component in rest) < 0.02
    # Four standard errors of a deviation from 720 and 180 values.
    np.testing.assert_allclose(np.sqrt(right.covariance.diagonal()), SD, rtol=0.11)
    np.testing.assert_allclose(np.sqrt(wrong.covariance.diagonal()), SD, rtol=0.22)
    assert wrong.weight == pytest.approx(turned.mean(), abs=0.02)
    np.testing.assert_allclose(wrong.offset.rotation.log(), [0, np.pi / 2, 0], atol=0.03)
    assert fit.bic == min(each.bic for each in fit.fits)
    assert fit.log_likelihood == fit.fits[fit.chosen].log_likelihood
    # The errors are white, and without stamps there is no time.
    assert fit.noise.dependence.slow is None and fit.noise.dependence.mode_time_s == 0
    assert fit.slow_error.models[fit.slow_error.chosen].decay == px.SlowErrorDecay.none
    np.testing.assert_allclose(fit.slow_error.white_sd, SD, rtol=0.11)
    assert fit.to_toml("cup") == fit.noise.to_toml("cup")
    again = px.fit_noise(truth, detected, recording=recording, settings=settings, seed=2)
    assert again.noise == fit.noise


def test_misses_and_frames_without_truth_do_not_count(rng: np.random.Generator) -> None:
    truth = poses(rng, 200)
    detected = truth * px.SE3.exp(rng.normal(size=(200, 6)) * SD)
    settings = px.NoiseFitSettings(max_components=1, frame=px.NoiseFrame.object)
    frame = np.arange(200)
    some_truth = px.with_misses(truth, known=frame >= 20)
    some_detected = px.with_misses(detected, known=frame < 180)
    some = px.fit_noise(some_truth, some_detected, settings=settings)
    both = px.fit_noise(some_truth[20:180], some_detected[20:180], settings=settings)
    assert some.log_likelihood == both.log_likelihood


def test_slow_errors_with_their_standard_errors(rng: np.random.Generator) -> None:
    """Errors of 10 s in recordings of 200 frames, while the object stands still before the camera."""
    stamps = np.tile(0.5 * np.arange(200), 6)
    decay = np.exp(-0.5 / 10)
    slow = np.zeros((1200, 6))
    for i in range(1200):
        fresh = rng.normal(size=6) * 2 * SD
        slow[i] = fresh if i % 200 == 0 else decay * slow[i - 1] + np.sqrt(1 - decay**2) * fresh
    truth = px.SE3(translation=np.tile([0.0, 0.0, 1.0], (1200, 1)))
    detected = truth * px.SE3.exp(slow + rng.normal(size=(1200, 6)) * SD)
    settings = px.NoiseFitSettings(max_components=1, restarts=1, frame=px.NoiseFrame.object)
    recording = np.repeat(np.arange(6), 200)
    fit = px.fit_noise(truth, detected, recording=recording, stamps=stamps, settings=settings)
    found = fit.slow_error
    assert found.models[found.chosen].decay == px.SlowErrorDecay.time
    assert found.slow == fit.noise.dependence.slow
    assert found.slow.correlation_time_s == pytest.approx(10, abs=3 * found.correlation_time_error_s)
    assert np.all(np.abs(found.white_sd - SD) < 4 * found.white_sd_error)
    assert np.all(np.abs(found.slow_sd - 2 * SD) < 4 * found.slow_sd_error)
    assert found.is_jackknife and found.recordings == 6
    assert "correlation_time_s" in fit.to_toml()
    with pytest.raises(ValueError, match="stamps do not decrease"):
        px.fit_noise(truth, detected, recording=recording, stamps=-stamps, settings=settings)
    with pytest.raises(ValueError, match="5 stamps"):
        px.fit_noise(truth, detected, stamps=stamps[:5], settings=settings)


def test_text_is_read_back(rng: np.random.Generator) -> None:
    noise = px.default_detector_noise()
    assert noise.to_toml().startswith("[noise.detector]\n")
    with pytest.raises(ValueError, match="the name is 'a b'"):
        noise.to_toml("a b")


def test_bad_input_is_refused(rng: np.random.Generator) -> None:
    truth = poses(rng, 10)
    with pytest.raises(ValueError, match="expected as many"):
        px.fit_noise(truth, truth[:5])
    with pytest.raises(ValueError, match="modes without clutter"):
        px.fit_noise(truth, truth, settings=px.NoiseFitSettings(clutter=False))


def test_odometry_noise_of_a_walk(rng: np.random.Generator) -> None:
    """Steps of 0.1 s whose errors have 0.01 rad and 5 mm per square root of a second."""
    sd = np.repeat([0.01, 0.005], 3)
    recordings = []
    for _ in range(10):
        errors = px.SE3.exp(rng.normal(size=(400, 6)) * sd * np.sqrt(0.1))
        odometry = [px.SE3()]
        for error in errors:
            odometry.append(odometry[-1] * error)
        rows = np.stack([pose.to_tq() for pose in odometry])
        still = np.tile(px.SE3().to_tq(), (len(rows), 1))
        recordings.append(
            px.Sequence(
                stamps=0.1 * np.arange(len(rows)),
                odometry=px.with_misses(rows),
                camera_truth=px.with_misses(still),
                objects=[],
            )
        )
    noise = px.fit_odometry_noise(recordings, px.OdometryNoiseSettings(bootstrap=20))
    np.testing.assert_allclose(noise.sd_per_sqrt_s, sd, rtol=0.15)
    assert noise.recordings == 10
    assert '[motion]\nmodel = "odometry"' in noise.to_toml()


def test_what_is_no_recording_is_named() -> None:
    with pytest.raises(TypeError, match=r"recordings\[1\] is of type int; expected a Sequence"):
        px.fit_odometry_noise([px.Sequence([0.0]), 1])  # type: ignore[list-item]
