# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Curves: marginals about an axis, consistency and mode probabilities over time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from posemix._arrays import FloatArray, as_floats
from posemix.lie import SE3, SO3
from posemix.mixture import Mixture
from posemix.plot.style import Axes, colour_of

__all__ = ["axis_marginal", "chi_square_quantile", "mode_probabilities", "nees"]


def _rotations(points: SO3 | SE3) -> SO3:
    return points if isinstance(points, SO3) else points.rotation


def axis_marginal(
    ax: Axes,
    mixture: Mixture[Any],
    axis: npt.ArrayLike,
    *,
    reference: SO3 | None = None,
    samples: int = 20_000,
    bins: int = 180,
    seed: int = 0,
) -> tuple[list[Any], Any]:
    """The distribution of the rotation angle about an axis of the body, component by component, by sampling.

    The angle is that of q_ref^-1 q about the axis (swing and twist): 2 atan2(q_v . axis, q_w), in (-180, 180] degrees.

    Parameters
    ----------
    ax : Axes
        Two-dimensional axes.
    mixture : Mixture
        Mixture over rotations or poses.
    axis : array_like, shape (3,)
        The axis in the body frame, of any length but zero.
    reference : SO3, optional
        The rotation at angle zero; by default that of the heaviest component's mean.
    samples, bins, seed : int
        Draws from every component, cells of the histogram, seed of the draws.

    Returns
    -------
    components : list of StepPatch
        Densities of the components times their weights, the heaviest first.
    total : StepPatch
        Sum of the components [1/deg].
    """
    direction = as_floats(axis, (3,), "axis")
    length = float(np.linalg.norm(direction))
    if not length > 0.0:
        raise ValueError("axis is zero; expected a direction")
    order = np.argsort(-mixture.log_weights, kind="stable")
    centre = _rotations(mixture[int(order[0])].mean) if reference is None else reference
    edges = np.linspace(-180.0, 180.0, bins + 1)
    sum_of_all = np.zeros(bins)
    artists = []
    for place, k in enumerate(order.tolist()):
        q = (centre.inverse() * _rotations(mixture[k].sample(samples, seed))).quaternion
        turns = np.degrees(2.0 * np.arctan2(q[:, :3] @ (direction / length), q[:, 3]))
        turns = -((180.0 - turns) % 360.0 - 180.0)
        heights = np.histogram(turns, edges)[0] / (samples * (edges[1] - edges[0]))
        heights = heights * mixture.weights[k]
        sum_of_all += heights
        shade = colour_of(place)
        label = f"component {k}, weight {mixture.weights[k]:.3g}"
        artists.append(ax.stairs(heights, edges, fill=True, color=shade, alpha=0.4, label=label))
    total = ax.stairs(sum_of_all, edges, color="#333333", label="mixture")
    ax.set(xlabel="turn about the axis [deg]", ylabel="density [1/deg]", xlim=(-180.0, 180.0))
    return artists, total


def _gamma_p(a: float, x: float) -> float:
    """The regularised lower incomplete gamma function P(a, x)."""
    if x <= 0.0:
        return 0.0
    scale = math.exp(a * math.log(x) - x - math.lgamma(a))
    if x < a + 1.0:
        term = total = 1.0 / a
        n = a
        while abs(term) > 1e-16 * abs(total):
            n += 1.0
            term *= x / n
            total += term
        return total * scale
    # Continued fraction of Q(a, x), by Lentz's method.
    b = x + 1.0 - a
    c, d = 1e300, 1.0 / b
    h = d
    for i in range(1, 10_000):
        factor = -i * (i - a)
        b += 2.0
        d = 1.0 / (factor * d + b)
        c = b + factor / c
        h *= c * d
        if abs(c * d - 1.0) < 1e-15:
            break
    return 1.0 - scale * h


def chi_square_quantile(probability: float, dof: float) -> float:
    """The quantile of the chi-square distribution with `dof` degrees of freedom."""
    if not (0.0 < probability < 1.0 and dof > 0.0):
        raise ValueError(
            f"probability is {probability} and dof {dof}; expected one between 0 and 1, and a positive number"
        )
    low, high = 0.0, dof
    while _gamma_p(0.5 * dof, 0.5 * high) < probability:
        high *= 2.0
    while high - low > 1e-13 * high:
        middle = 0.5 * (low + high)
        if _gamma_p(0.5 * dof, 0.5 * middle) < probability:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def nees(
    ax: Axes,
    times: npt.ArrayLike,
    values: npt.ArrayLike,
    *,
    dof: int,
    runs: int = 1,
    probability: float = 0.95,
    colour: str | None = None,
    label: str | None = None,
) -> tuple[Any, Any]:
    """The NEES over time, and the band in which it lies with a probability if the filter is consistent.

    Parameters
    ----------
    ax : Axes
        Two-dimensional axes.
    times : array_like, shape (n,)
        Times [s].
    values : array_like, shape (n,)
        e^T P^-1 e, the mean over `runs` runs, or NaN. It is drawn divided by `dof`, so that 1 is consistent and more is
        overconfident.
    dof : int
        Dimensions of e, 6 for a pose.
    runs : int
        Number of independent runs that each value is the mean of.
    probability : float
        Probability of the band, chi-square with runs * dof degrees of freedom.
    colour, label : str, optional
        Colour and label of the curve.

    Returns
    -------
    line : Line2D
    band : Rectangle
        Polygon before matplotlib 3.9.
    """
    if runs < 1 or dof < 1:
        raise ValueError(f"dof is {dof} and runs {runs}; expected at least 1")
    t = np.asarray(times, dtype=np.float64)
    y = np.asarray(values, dtype=np.float64) / dof
    if t.shape != y.shape or t.ndim != 1:
        raise ValueError(f"times have shape {t.shape}, values {y.shape}; expected (n,) of both")
    total = runs * dof
    low, high = (
        chi_square_quantile(p, total) / total
        for p in (0.5 - 0.5 * probability, 0.5 + 0.5 * probability)
    )
    band = ax.axhspan(
        low, high, color="#777777", alpha=0.2, linewidth=0.0, label=f"{100 * probability:g} % band"
    )
    (line,) = ax.plot(t, y, color=colour or colour_of(0), label=label)
    ax.set(xlabel="time [s]", ylabel=f"NEES / {dof}")
    return line, band


def mode_probabilities(
    ax: Axes,
    times: npt.ArrayLike,
    probabilities: npt.ArrayLike,
    *,
    labels: Sequence[str] | None = None,
) -> list[Any]:
    """Probabilities of modes or hypotheses over time, stacked.

    Parameters
    ----------
    ax : Axes
        Two-dimensional axes.
    times : array_like, shape (n,)
        Times [s].
    probabilities : array_like, shape (n, k)
        Probabilities; NaN is drawn as zero.
    labels : sequence of str, optional
        Labels of the k modes.

    Returns
    -------
    list of PolyCollection
        One per mode.
    """
    t = np.asarray(times, dtype=np.float64)
    shares: FloatArray = np.nan_to_num(np.asarray(probabilities, dtype=np.float64))
    if shares.ndim != 2 or shares.shape[0] != len(t):
        raise ValueError(f"probabilities have shape {shares.shape}; expected ({len(t)}, k)")
    if ((shares < 0.0) | (shares > 1.0 + 1e-9)).any():
        raise ValueError("probabilities lie outside [0, 1]")
    k = shares.shape[1]
    names = [f"mode {i}" for i in range(k)] if labels is None else list(labels)
    if len(names) != k:
        raise ValueError(f"labels are {len(names)}; expected {k}")
    colours = [colour_of(i) for i in range(k)]
    artists: list[Any] = ax.stackplot(t, shares.T, labels=names, colors=colours, alpha=0.8)
    ax.set(xlabel="time [s]", ylabel="probability", ylim=(0.0, 1.0))
    return artists
