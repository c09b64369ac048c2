# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Groups against scipy, which computes exponentials of matrices by Pade approximation."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest
from scipy.linalg import expm, logm
from scipy.spatial.transform import Rotation

from posemix import SE3, SO3, interpolate, weighted_mean


def hat(xi: np.ndarray) -> np.ndarray:
    x, y, z = xi[:3]
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    if len(xi) == 3:
        return cross
    m = np.zeros((4, 4))
    m[:3, :3] = cross
    m[:3, 3] = xi[3:]
    return m


@pytest.mark.parametrize("group", [SO3, SE3])
@pytest.mark.parametrize("scale", [1e-9, 1e-3, 1.0])
def test_exp_is_the_matrix_exponential(group: type, scale: float, rng: np.random.Generator) -> None:
    xi = scale * rng.normal(size=(20, group.DOF))
    expected = np.stack([expm(hat(v)) for v in xi])
    np.testing.assert_allclose(group.exp(xi).matrix(), expected, atol=1e-13)


@pytest.mark.parametrize("group", [SO3, SE3])
def test_log_undoes_exp(group: type, rng: np.random.Generator) -> None:
    xi = rng.normal(size=(7, 5, group.DOF))
    x = group.exp(xi)
    assert x.shape == (7, 5)
    assert group.exp(x.log()).is_approx(x, 1e-12)
    np.testing.assert_allclose(
        hat(x[3, 2].log()), np.real(logm(x[3, 2].matrix())), atol=1e-10
    )


def test_quaternions_are_those_of_scipy(rng: np.random.Generator) -> None:
    q = rng.normal(size=(50, 4))
    ours, theirs = SO3(q), Rotation.from_quat(q)
    np.testing.assert_allclose(ours.matrix(), theirs.as_matrix(), atol=1e-14)
    np.testing.assert_allclose(ours.log(), theirs.as_rotvec(), atol=1e-12)
    np.testing.assert_allclose(ours.angle(), theirs.magnitude(), atol=1e-12)


def test_products_are_broadcast(rng: np.random.Generator) -> None:
    a = SE3.exp(rng.normal(size=(4, 1, 6)))
    b = SE3.exp(rng.normal(size=(3, 6)))
    product = a * b
    assert product.shape == (4, 3)
    np.testing.assert_allclose(product.matrix(), a.matrix() @ b.matrix(), atol=1e-13)
    points = rng.normal(size=(3, 3))
    moved = np.einsum("abij,bj->abi", product.rotation.matrix(), points) + product.translation
    np.testing.assert_allclose(product.act(points), moved, atol=1e-13)
    assert (a * a.inverse()).is_approx(SE3.identity((4, 1)))


@pytest.mark.parametrize("group", [SO3, SE3])
def test_jacobians_are_numeric_derivatives(group: type, rng: np.random.Generator) -> None:
    xi = rng.normal(size=group.DOF)
    step = 1e-6
    columns = [
        ((group.exp(xi + d) * group.exp(xi - d).inverse()).log()) / (2 * step)
        for d in step * np.eye(group.DOF)
    ]
    left = group.left_jacobian(xi)
    np.testing.assert_allclose(left, np.stack(columns, axis=1), atol=1e-8)
    np.testing.assert_allclose(left @ group.left_jacobian_inverse(xi), np.eye(group.DOF), atol=1e-12)
    np.testing.assert_allclose(group.right_jacobian(xi), group.left_jacobian(-xi), atol=1e-15)
    x = group.exp(xi)
    v = rng.normal(size=group.DOF)
    conjugated = x * group.exp(v) * x.inverse()
    np.testing.assert_allclose(group.exp(x.adjoint() @ v).matrix(), conjugated.matrix(), atol=1e-12)


def test_the_geodesic_and_the_mean(rng: np.random.Generator) -> None:
    a, b = SE3.exp(rng.normal(size=(2, 6)))
    path = interpolate(a, b, [0.0, 0.25, 1.0])
    assert path[0].is_approx(a) and path[2].is_approx(b)
    np.testing.assert_allclose((path[1] * a.inverse()).log(), 0.25 * (b * a.inverse()).log(), atol=1e-12)
    half = interpolate(a, b, 0.5)
    assert half.shape == () and half.is_approx(interpolate(a, b, [0.5])[0], 0.0)
    assert interpolate(a, b, np.ones((2, 3))).shape == (2, 3)
    x = SE3.exp(0.3 * rng.normal(size=(30, 6)))
    mean = weighted_mean(x)
    np.testing.assert_allclose((x * mean.inverse()).log().mean(axis=0), 0.0, atol=1e-10)


@pytest.mark.parametrize("element", [SO3.exp([1.0, 2.0, 0.5]), SE3.exp(np.ones((3, 6)))])
def test_copies_are_equal_to_the_last_bit(element: SO3 | SE3) -> None:
    for made in (pickle.loads(pickle.dumps(element)), copy.deepcopy(element)):
        assert type(made) is type(element)
        np.testing.assert_array_equal(made._data, element._data)


def test_bad_values_are_refused() -> None:
    with pytest.raises(ValueError, match=r"xi has shape \(5,\); expected \(..., 6\)"):
        SE3.exp(np.zeros(5))
    with pytest.raises(ValueError, match="quaternion has zero norm"):
        SO3([0, 0, 0, 0])
    with pytest.raises(ValueError, match="not orthonormal"):
        SO3.from_matrix(2 * np.eye(3))
    with pytest.raises(ValueError, match=r"translation holds nan at index \(1,\)"):
        SE3(translation=[0, np.nan, 0])
    with pytest.raises(ValueError, match="broadcast"):
        SE3.identity(3) * SE3.identity(4)


def test_memory_that_fits_is_not_copied() -> None:
    from posemix._arrays import as_floats, as_vectors

    xi = np.zeros((10, 6))
    assert np.shares_memory(as_floats(xi, (6,), "xi"), xi)
    table = np.zeros((10, 8))
    rows, shape = as_vectors(table[::2, 1:7], 6, "xi")
    assert np.shares_memory(rows, table)
    assert shape == (5,)


def test_vectors_apart_are_those_next_to_each_other(rng: np.random.Generator) -> None:
    table = rng.normal(size=(37, 14))
    for apart in (table[:, 1:7], table[::3, :6], table[::-1, :6], table[:, ::2][:, :6], table.T[:6].T):
        np.testing.assert_array_equal(SE3.exp(apart)._data, SE3.exp(apart.copy())._data)
        np.testing.assert_array_equal(SE3.left_jacobian(apart), SE3.left_jacobian(apart.copy()))
        np.testing.assert_array_equal(SE3.ad(apart), SE3.ad(apart.copy()))


@pytest.mark.parametrize("group", [SO3, SE3])
def test_results_have_the_same_bits_by_any_number_of_threads(
    group: type, rng: np.random.Generator
) -> None:
    xi = rng.normal(size=(40001, group.DOF))
    x = group.exp(xi)
    for threads in (0, 2, 5):
        np.testing.assert_array_equal(group.exp(xi, threads=threads)._data, x._data)
        np.testing.assert_array_equal(x.log(threads=threads), x.log())
        for jacobian in (group.left_jacobian, group.right_jacobian_inverse):
            np.testing.assert_array_equal(jacobian(xi, threads=threads), jacobian(xi))
    with pytest.raises(ValueError, match="threads is -1; expected 1 or more, or 0 for one per core"):
        group.exp(xi, threads=-1)


def test_what_is_not_a_number_stays_in_its_place() -> None:
    xi = np.zeros((9, 6))
    xi[4, 1] = np.nan
    assert np.isnan(SE3.exp(xi).log()).any(axis=-1).tolist() == [i == 4 for i in range(9)]


def test_an_ellipsis_is_an_index_as_in_numpy(rng: np.random.Generator) -> None:
    x = SE3.exp(rng.normal(size=(2, 3, 6)))
    assert x[...].is_approx(x, 0.0) and x[..., 0].is_approx(x[:, 0], 0.0) and x[1, ...].is_approx(x[1], 0.0)


def test_a_shape_is_of_whole_numbers() -> None:
    shapes = [SO3.identity(shape).shape for shape in (2, np.int64(2), (2, 3), [2], ())]
    assert shapes == [(2,), (2,), (2, 3), (2,), ()]
    for shape in (2.7, 2.0, (1, 2.5), "2"):
        with pytest.raises(TypeError, match="expected a whole number or a tuple of them"):
            SE3.identity(shape)  # type: ignore[arg-type]


def test_one_number_is_no_array() -> None:
    with pytest.raises(ValueError, match=r"points has shape \(\); expected \(..., 3\)"):
        SE3().act(1.0)
