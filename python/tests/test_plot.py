# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("Agg")

import matplotlib.pyplot as plt
from matplotlib.colors import to_hex

from posemix import SE3, SO3, ConcentratedGaussian, Mixture, ProjectedGaussian, plot

COVARIANCE = np.diag([0.02, 0.01, 0.03, 1e-4, 4e-4, 9e-4])


@pytest.fixture
def flat() -> Iterator[Any]:
    figure, ax = plt.subplots()
    yield ax
    figure.canvas.draw()
    plt.close(figure)


@pytest.fixture
def space() -> Iterator[Any]:
    figure, ax = plt.subplots(subplot_kw={"projection": "3d"})
    yield ax
    figure.canvas.draw()
    plt.close(figure)


@pytest.fixture
def poses() -> SE3:
    return SE3.exp(np.random.default_rng(2).normal(size=(15, 6)))


def test_flags_on_a_plane(flat: Any, poses: SE3) -> None:
    poles, pennants = plot.flags(flat, poses, length=0.1, plane="xz", label="samples")
    segments = np.array(poles.get_segments())
    z = poses.rotation.act([0.0, 0.0, 0.1])
    np.testing.assert_allclose(segments[:, 0], poses.translation[:, [0, 2]])
    np.testing.assert_allclose(segments[:, 1], (poses.translation + z)[:, [0, 2]])
    tip = poses.act([0.06, 0.0, 0.08])
    vertices = [path.vertices for path in pennants.get_paths()]
    np.testing.assert_allclose(vertices[3][2], tip[3, [0, 2]])
    assert (flat.get_xlabel(), flat.get_ylabel()) == ("x [m]", "z [m]")
    low, high = flat.get_xlim()
    assert low < poses.translation[:, 0].min() < poses.translation[:, 0].max() < high


def test_flags_in_space(space: Any, poses: SE3) -> None:
    poles, _ = plot.flags(space, poses)
    segments = np.array(poles._segments3d)
    np.testing.assert_allclose(segments[:, 0], poses.translation)
    np.testing.assert_allclose(np.linalg.norm(np.diff(segments, axis=1), axis=-1), 0.03)
    assert space.get_zlabel() == "z [m]"


@pytest.mark.parametrize("count", [0, 1])
def test_few_flags(flat: Any, space: Any, count: int) -> None:
    for ax in (flat, space):
        poles, pennants = plot.flags(ax, SE3.identity(count))
        assert poles is not pennants
        plot.flags(ax, SE3())


def test_position_covariance_is_that_of_samples() -> None:
    density = ConcentratedGaussian(SE3(SO3.exp([0.2, 0.4, 1.0]), [1.0, 2.0, -1.0]), 0.01 * COVARIANCE)
    point = np.array([0.3, 0.1, 0.2])
    drawn = np.cov(density.sample(50_000, 1).act(point).T)
    found = plot.position_covariance(density.mean, density.covariance, point)
    scale = np.sqrt(np.outer(np.diagonal(found), np.diagonal(found)))
    assert (np.abs(found - drawn) / scale).max() < 0.03


def test_ellipsoid_on_a_plane(flat: Any) -> None:
    density = ConcentratedGaussian(SE3(translation=[0.0, 0.0, 0.0]), COVARIANCE)
    outline = plot.ellipsoid(flat, density, sigmas=2.0, plane="yz").get_xy()
    np.testing.assert_allclose(np.abs(outline).max(axis=0), [2 * 0.02, 2 * 0.03], rtol=1e-3)


def test_ellipsoid_in_space(space: Any) -> None:
    density = ConcentratedGaussian(SE3(translation=[1.0, 2.0, 3.0]), COVARIANCE)
    surface = plot.ellipsoid(space, density)
    faces = np.array(surface._faces if hasattr(surface, "_faces") else surface._vec[:3].T).reshape((-1, 3))
    cloud = faces - [1.0, 2.0, 3.0]
    inverse = np.linalg.inv(plot.position_covariance(density.mean, density.covariance))
    np.testing.assert_allclose(np.einsum("ni,ij,nj->n", cloud, inverse, cloud), 9.0, rtol=1e-9)


def test_bananas_hold_what_they_say(flat: Any) -> None:
    """A lever of 1 m that turns by 30 degrees: the region bends, and holds its probability of other draws."""
    covariance = np.diag([1e-6, 1e-6, np.radians(30.0) ** 2, 1e-4, 1e-4, 1e-4])
    density = ConcentratedGaussian(SE3(translation=[1.0, 0.0, 0.0]), covariance)
    contours = plot.position_contours(flat, density, levels=(0.9,))
    (paths,) = contours.get_paths()
    drawn = density.sample(5_000, 99).translation[:, :2]
    assert paths.contains_points(drawn).mean() == pytest.approx(0.9, abs=0.03)
    # Straight on along the tangent, as far as the ends of the banana, is outside of it.
    assert not paths.contains_points([[1.0, 0.7]])[0]
    assert paths.contains_points([[np.cos(0.7), np.sin(0.7)]])[0]


def test_bananas_of_other_laws(flat: Any) -> None:
    projected = ProjectedGaussian.at_mean(SE3(), 0.1 * COVARIANCE)
    far = ConcentratedGaussian(SE3(translation=[1.0, 0.0, 0.0]), 0.01 * COVARIANCE)
    near = ConcentratedGaussian(SE3(), 0.01 * COVARIANCE)
    for distribution in (projected, Mixture([far, near])):
        contours = plot.position_contours(flat, distribution, levels=(0.5, 0.9), point=[0.1, 0.0, 0.0])
        assert len(contours.levels) == 2
    with pytest.raises(ValueError, match="between 0 and 1"):
        plot.position_contours(flat, projected, levels=(1.0,))


def test_tube_on_a_plane(flat: Any) -> None:
    path = SE3(SO3.identity(11), np.linspace(0, 1, 11)[:, None] * [1.0, 0.0, 0.0])
    covariance = np.diag([1e-12] * 3 + [1.0, 4e-4, 1.0])
    line, tube = plot.trajectory(flat, path, np.tile(covariance, (11, 1, 1)), label="camera")
    np.testing.assert_allclose(line.get_xydata()[:, 0], np.linspace(0, 1, 11))
    np.testing.assert_allclose(np.abs(tube.get_xy()[:, 1]), 0.06, rtol=1e-4)


def test_tube_in_space(space: Any) -> None:
    path = SE3(SO3.identity(6), np.linspace(0, 1, 6)[:, None] * [0.0, 0.0, 1.0])
    covariance = np.diag([1e-12] * 3 + [1e-4, 4e-4, 1.0])
    line, tube = plot.trajectory(space, path, np.tile(covariance, (6, 1, 1)), sigmas=1.0)
    assert line.get_data_3d()[2].tolist() == pytest.approx(np.linspace(0, 1, 6).tolist())
    faces = np.array(tube._faces if hasattr(tube, "_faces") else tube._vec[:3].T).reshape((-1, 3))
    np.testing.assert_allclose(np.abs(faces[:, :2]).max(axis=0), [0.01, 0.02], rtol=1e-3)
    assert faces[:, 2].min() == pytest.approx(0.0)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_paths_that_stand_still(flat: Any, space: Any, count: int) -> None:
    for ax in (flat, space):
        _, tube = plot.trajectory(ax, SE3.identity(count), np.tile(COVARIANCE, (count, 1, 1)))
        assert (tube is None) == (count == 1)
    with pytest.raises(ValueError, match="covariances are 2; expected 3"):
        plot.trajectory(flat, SE3.identity(3), np.tile(COVARIANCE, (2, 1, 1)))


def test_marginal_about_an_axis(flat: Any) -> None:
    sd = np.radians(6.0)
    covariance = np.diag([1e-6, 1e-6, sd**2])
    start = SO3.exp([0.3, -0.2, 0.5])
    # In the body's frame the uncertain axis is z.
    left = start.adjoint() @ covariance @ start.adjoint().T
    modes = [
        ConcentratedGaussian(start * SO3.exp([0.0, 0.0, angle]), left) for angle in (0.0, np.pi / 2)
    ]
    components, total = plot.axis_marginal(flat, Mixture(modes, [0.25, 0.75]), [0, 0, 2], bins=360)
    heights, edges, _ = total.get_data()
    assert heights.sum() * 1.0 == pytest.approx(1.0)
    centres = 0.5 * (edges[1:] + edges[:-1])
    # The heaviest is where the turn is zero, the other a quarter turn back.
    assert heights[np.abs(centres) < 30].sum() == pytest.approx(0.75)
    assert heights[np.abs(centres + 90) < 30].sum() == pytest.approx(0.25)
    first = components[0].get_data().values
    assert np.sqrt((first * centres**2).sum() / first.sum()) == pytest.approx(6.0, rel=0.03)
    assert flat.get_xlabel() == "turn about the axis [deg]"


def test_marginal_of_a_single_pose(flat: Any) -> None:
    single = Mixture([ConcentratedGaussian(SE3(), COVARIANCE)])
    components, _ = plot.axis_marginal(flat, single, [1, 0, 0], reference=SO3.exp([3.1, 0, 0]))
    assert len(components) == 1
    with pytest.raises(ValueError, match="axis is zero"):
        plot.axis_marginal(flat, single, [0, 0, 0])


def test_chi_square_quantiles_are_those_of_scipy() -> None:
    stats = pytest.importorskip("scipy.stats")
    for probability in (1e-6, 0.025, 0.5, 0.975, 0.9999):
        for dof in (1, 2, 6, 60, 3000):
            expected = stats.chi2.ppf(probability, dof)
            assert plot.chi_square_quantile(probability, dof) == pytest.approx(expected, rel=1e-9)
    with pytest.raises(ValueError, match="between 0 and 1"):
        plot.chi_square_quantile(1.0, 6)


def test_nees_and_its_band(flat: Any) -> None:
    values = np.array([6.0, 3.0, np.nan, 12.0])
    line, band = plot.nees(flat, np.arange(4.0), values, dof=6, runs=10, label="filter")
    np.testing.assert_allclose(line.get_ydata(), values / 6)
    low, high = band.get_y(), band.get_y() + band.get_height()
    assert low == pytest.approx(plot.chi_square_quantile(0.025, 60) / 60)
    assert high == pytest.approx(plot.chi_square_quantile(0.975, 60) / 60)
    plot.nees(flat, [], [], dof=6)
    with pytest.raises(ValueError, match="expected at least 1"):
        plot.nees(flat, [], [], dof=6, runs=0)
    with pytest.raises(ValueError, match=r"expected \(n,\) of both"):
        plot.nees(flat, [1.0], [], dof=6)


def test_mode_probabilities(flat: Any) -> None:
    shares = np.array([[0.5, 0.5], [0.8, 0.2], [np.nan, 1.0]])
    areas = plot.mode_probabilities(flat, [0.0, 0.1, 0.2], shares, labels=["up", "flipped"])
    assert len(areas) == 2
    assert [to_hex(area.get_facecolor()[0]).upper() for area in areas] == list(plot.PALETTE[:2])
    tops = areas[1].get_paths()[0].vertices
    assert tops[:, 1].max() == pytest.approx(1.0)
    assert areas[0].get_label() == "up"
    with pytest.raises(ValueError, match="expected 2"):
        plot.mode_probabilities(flat, [0, 1, 2], shares, labels=["up"])
    with pytest.raises(ValueError, match="outside"):
        plot.mode_probabilities(flat, [0.0], [[1.5]])


def test_planes_are_checked(flat: Any) -> None:
    with pytest.raises(ValueError, match="expected two of x, y and z"):
        plot.flags(flat, SE3(), plane="xx")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="positive"):
        plot.flags(flat, SE3(), length=0.0)


def test_tubes_are_not_twisted(space: Any) -> None:
    """Around a circle every face joins points that lie side by side."""
    angles = np.linspace(0.0, 6.0, 200)
    circle = np.stack([np.cos(angles), np.sin(angles), 0.1 * angles], axis=1)
    path = SE3(SO3.identity(200), circle)
    spread = np.diag([1e-12] * 3 + [1e-4, 4e-4, 9e-4])
    _, tube = plot.trajectory(space, path, np.tile(spread, (200, 1, 1)))
    faces = np.array(tube._faces if hasattr(tube, "_faces") else tube._vec[:3].T).reshape((-1, 4, 3))
    assert np.linalg.norm(faces[:, 0] - faces[:, 1], axis=1).max() < 0.05
