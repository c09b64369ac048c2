# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Weighted sums of densities."""

from __future__ import annotations

import html
import operator
from collections.abc import Iterator, Sequence
from typing import Any, Generic, TypeVar

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray
from posemix.density import (
    ConcentratedGaussian,
    ProjectedGaussian,
    rows_of,
    standard_deviations,
)
from posemix.lie import SE3, SO3
from posemix.random import RandomStream, stream_of

__all__ = ["Mixture"]

D = TypeVar("D", bound="ConcentratedGaussian[Any] | ProjectedGaussian[Any]")

# The compiled functions, whose overloads depend on the kind of density, which mypy cannot tell from a type variable.
overloaded: Any = _core

_MIXTURES: dict[type, Any] = {
    _core.ConcentratedSO3: _core.MixtureConcentratedSO3,
    _core.ConcentratedSE3: _core.MixtureConcentratedSE3,
    _core.ConcentratedStack: _core.MixtureConcentratedStack,
    _core.ProjectedSO3: _core.MixtureProjectedSO3,
    _core.ProjectedSE3: _core.MixtureProjectedSE3,
}


def log_of_weights(weights: npt.ArrayLike) -> FloatArray:
    """Logarithms of weights that are finite and not negative."""
    values = np.ascontiguousarray(weights, dtype=np.float64)
    if values.ndim != 1:
        raise ValueError(f"weights has shape {values.shape}; expected (k,)")
    for i, weight in enumerate(values):
        if not (weight >= 0.0 and np.isfinite(weight)):
            raise ValueError(f"weight {i} is {weight}, expected a finite number >= 0")
    with np.errstate(divide="ignore"):
        return np.log(values)


def scaled_weights(logs: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Weights over the largest of them on the last axis, and its logarithm; zeros and 0 where all are zero."""
    largest = logs.max(axis=-1)
    largest = np.where(np.isneginf(largest), 0.0, largest)
    return np.exp(logs - largest[..., None]), largest


class Mixture(Generic[D]):
    """A weighted sum of densities of one kind.

    Parameters
    ----------
    densities : sequence of ConcentratedGaussian or of ProjectedGaussian
        The components' densities, all on one group.
    weights : array_like, shape (k,), optional
        Weights, not negative; they are normalised. Equal unless given.
    log_weights : array_like, shape (k,), optional
        Natural logarithms of the weights, instead of `weights`.

    Raises
    ------
    ValueError
        For no component, numbers of densities and weights that differ, and weights that are negative, not finite or
        all zero.

    Examples
    --------
    >>> import numpy as np
    >>> from posemix import ConcentratedGaussian, Mixture, SE3, SO3
    >>> covariance = np.diag([0.01] * 3 + [1e-4] * 3)
    >>> flipped = SE3(SO3.exp([0, 0, np.pi]))
    >>> modes = [ConcentratedGaussian(pose, covariance) for pose in (SE3(), flipped)]
    >>> mixture = Mixture(modes, weights=[0.7, 0.3])
    >>> mixture.weights.round(2)
    array([0.7, 0.3])
    >>> mixture.log_density(mixture.sample(10_000, seed=1)).shape
    (10000,)
    """

    __slots__ = ("_handle",)

    def __init__(
        self,
        densities: Sequence[D],
        weights: npt.ArrayLike | None = None,
        *,
        log_weights: npt.ArrayLike | None = None,
    ) -> None:
        if not densities:
            raise ValueError("a mixture needs at least one component")
        if weights is not None and log_weights is not None:
            raise ValueError("weights and log_weights are both given; expected one of them")
        for i, density in enumerate(densities):
            if type(getattr(density, "_handle", None)) not in _MIXTURES:
                kind = type(density).__name__
                raise TypeError(f"densities[{i}] is a {kind}; expected a ConcentratedGaussian or a ProjectedGaussian")
        kinds = {type(density._handle) for density in densities}
        if len(kinds) > 1:
            names = sorted(kind.__name__ for kind in kinds)
            raise ValueError(f"components of different kinds: {', '.join(names)}")
        if log_weights is not None:
            logs = np.ascontiguousarray(log_weights, dtype=np.float64)
            if logs.ndim != 1:
                raise ValueError(f"log_weights has shape {logs.shape}; expected ({len(densities)},)")
        else:
            logs = log_of_weights(np.ones(len(densities)) if weights is None else weights)
        self._handle: Any = _MIXTURES[kinds.pop()](list(logs), list(densities))

    @classmethod
    def _of(cls, handle: Any) -> Mixture[D]:
        if isinstance(handle, cls):
            return handle
        mixture = cls.__new__(cls)
        mixture._handle = handle
        return mixture

    def __len__(self) -> int:
        return len(self._handle)

    def __getitem__(self, index: int) -> D:
        """The density of one component; a negative index counts from the end."""
        try:
            at = operator.index(index)
        except TypeError:
            raise TypeError(f"index is a {type(index).__name__}; expected a whole number") from None
        size = len(self)
        if not -size <= at < size:
            raise IndexError(f"index is {at}; expected {-size} to {size - 1} for a mixture of {size}")
        density: D = self._handle.density(at % size)
        return density

    def __iter__(self) -> Iterator[D]:
        return (self[i] for i in range(len(self)))

    @property
    def log_weights(self) -> FloatArray:
        """Natural logarithms of the weights, shape (k,)."""
        values: FloatArray = self._handle.log_weights
        return values

    @property
    def weights(self) -> FloatArray:
        """The weights, shape (k,); they sum to one."""
        return np.exp(self.log_weights)

    @property
    def means(self) -> Any:
        """The components' means as one array of elements, shape (k,)."""
        data = np.stack([density.mean._data for density in self])
        return self[0]._group._wrap(data, data.shape[:-1])

    @property
    def covariances(self) -> FloatArray:
        """The components' covariances, shape (k, dof, dof)."""
        return np.stack([density.covariance for density in self])

    def log_density(self, points: SO3 | SE3) -> FloatArray:
        """Log of the density with respect to the Haar measure [nats].

        Parameters
        ----------
        points : SO3 or SE3, shape (...)
            Elements; shape (..., n) for a mixture of joint densities.

        Returns
        -------
        ndarray, shape (...)
        """
        if self._is_joint:
            shares, largest = scaled_weights(self._weighted_logs(points))
            with np.errstate(divide="ignore"):
                return np.asarray(np.log(shares.sum(axis=-1)) + largest)
        result: FloatArray = self._handle.log_density(rows_of(points))
        return result.reshape(points.shape)

    def responsibilities(self, points: SO3 | SE3) -> FloatArray:
        """Probabilities of the components given each point, shape (..., k).

        NaN at points where the density of every component is zero.

        Parameters
        ----------
        points : SO3 or SE3, shape (...)
            Elements; shape (..., n) for a mixture of joint densities.
        """
        shares, _ = scaled_weights(self._weighted_logs(points))
        with np.errstate(invalid="ignore"):
            return np.asarray(shares / shares.sum(axis=-1, keepdims=True))

    def sample(self, count: int, seed: int | RandomStream) -> Any:
        """Draws, shape (count,), or (count, n) from a mixture of joint densities.

        Each draws a component by its weight first: the same seed gives the same draws.

        Parameters
        ----------
        count : int
            Number of draws.
        seed : int or RandomStream
            A seed, or a stream, which is advanced.
        """
        stream = stream_of(seed)
        if self._is_joint:
            return self._joint_sample(operator.index(count), stream)
        return self[0]._group._wrap(self._handle.sample(count, stream), (count,))

    def _joint_sample(self, count: int, stream: RandomStream) -> SE3:
        if count < 0:
            raise ValueError(f"count is {count}; expected 0 or more")
        densities = list(self)
        sums = np.cumsum(self.weights)
        heaviest = int(np.argmax(self.log_weights))
        data = np.empty((count, *self[0].mean.shape, 7))
        for row in data:
            i = int(np.searchsorted(sums, stream.uniform(1)[0], side="right"))
            row[...] = densities[i if i < len(densities) else heaviest].sample(1, stream)._data[0]
        return SE3._wrap(data, data.shape[:-1])

    @property
    def _is_joint(self) -> bool:
        return isinstance(self._handle, _core.MixtureConcentratedStack)

    def _weighted_logs(self, points: SO3 | SE3) -> FloatArray:
        """Logarithms of weight times density of every component, shape (..., k)."""
        if self._is_joint:
            logs = np.stack([density.log_density(points) for density in self], axis=-1)
        else:
            rows: FloatArray = self._handle.component_log_densities(rows_of(points))
            logs = rows.reshape((*points.shape, len(self)))
        return np.asarray(logs + self.log_weights)

    def prune(self, threshold: float) -> tuple[Mixture[D], float]:
        """The mixture without components lighter than `threshold`, and the weight dropped.

        The heaviest component always stays.
        """
        if not 0.0 <= threshold <= 1.0:
            raise ValueError(f"threshold is {threshold}; expected a number in [0, 1]")
        pruned: tuple[Mixture[D], float] = self._handle.prune(threshold)
        return pruned

    def marginal(self, index: int) -> Mixture[ConcentratedGaussian[SE3]]:
        """The marginal mixture of one pose of a joint mixture."""
        mixture: Mixture[ConcentratedGaussian[SE3]] = self._joint().marginal(index)
        return mixture

    def relative_pose(
        self, from_index: int, to_index: int
    ) -> Mixture[ConcentratedGaussian[SE3]]:
        """The mixture of ``T_from^-1 T_to``, including the cross-covariances of a joint mixture."""
        mixture: Mixture[ConcentratedGaussian[SE3]] = self._joint().relative_pose(from_index, to_index)
        return mixture

    def _joint(self) -> Any:
        if not self._is_joint:
            raise ValueError("these are densities of one element; expected joint densities")
        return self._handle

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]:
        return _restored, (list(self), self.log_weights)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Mixture):
            return NotImplemented
        return (
            len(self) == len(other)
            and np.array_equal(self.log_weights, other.log_weights)
            and all(a == b for a, b in zip(self, other, strict=True))
        )

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        lines = [f"Mixture of {len(self)}:"]
        heaviest = np.argsort(-self.log_weights, kind="stable")
        lines += [f"  {self.weights[i]:.4f}  {self[int(i)]!r}" for i in heaviest[:8]]
        if len(self) > 8:
            lines.append(f"  and {len(self) - 8} lighter")
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        """A table of the components, for notebooks."""
        rows = "".join(
            f"<tr><td>{weight:.4f}</td><td>{html.escape(repr(density.mean))}</td>"
            f"<td>{html.escape(standard_deviations(density.covariance))}</td></tr>"
            for weight, density in zip(self.weights, self, strict=True)
        )
        head = "<tr><th>weight</th><th>mean</th><th>standard deviations</th></tr>"
        return f"<table><thead>{head}</thead><tbody>{rows}</tbody></table>"


def _restored(densities: list[D], log_weights: FloatArray) -> Mixture[D]:
    return Mixture(densities, log_weights=log_weights)
