# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The jobs of bench/peers: what is done, how equal results must be, what a machine needs at least; their tables."""

from __future__ import annotations

import statistics
from dataclasses import dataclass
from typing import Any

UPPER_BLOCK = 1368  # operations of one 6x6 block of a merge: two congruences with [A 0; B A], and an outer product
# An update of 36 dimensions by 30: Cholesky's factor, the solve for 37 columns, the product of half of the covariance.
UPDATE = 30**3 / 3 + 30 * 30 * 37 + 36 * 37 * 30
SAMPLES, COMPONENTS = 100_000, 7  # of the mixtures on R^6
WHITEN = 53  # a difference, a triangular product and a squared norm of six numbers
MOMENTS = 2 * 28 + 13  # weighted sums of 1, x and half of x x^T


def blocks(dimensions: int) -> float:
    """6x6 blocks on and above the diagonal."""
    n = dimensions // 6
    return n * (n + 1) / 2


@dataclass(frozen=True)
class Job:
    """What is done, and what it takes at least: operations and bytes of one item.

    `tolerance` is the largest difference of a result from the library's, relative to the largest entry.
    """

    name: str
    work: str
    unit: str
    tolerance: float
    operations: float = 0.0
    bytes: float = 0.0


def merge(dimensions: int) -> Job:
    work = blocks(dimensions) * UPPER_BLOCK
    moved = 8.0 * (2 * blocks(dimensions) * 36 + dimensions**2)
    return Job(f"merge_{dimensions}", f"midway merge, {dimensions} dimensions", "us", 1e-10, work, moved)


JOBS = [
    Job("so3_exp", "Exp on SO(3)", "ns", 1e-12),
    Job("so3_log", "Log on SO(3)", "ns", 1e-12),
    Job("se3_exp", "Exp on SE(3)", "ns", 1e-12),
    Job("se3_log", "Log on SE(3)", "ns", 1e-10),
    Job("se3_left_jacobian_inverse", "inverse left Jacobian on SE(3)", "ns", 1e-10),
    Job("se3_compose", "product of two poses", "ns", 1e-12),
    Job("compose_covariances", "product of two uncertain poses", "ns", 1e-8, 684),
    Job("fuse", "fusion of two uncertain poses", "us", 1e-8),
    *(merge(n) for n in (12, 36, 66, 126)),
    Job("frame", "frame of the Gaussian-sum filter, 12 hypotheses x 2 x 5 objects", "us", 1e-9,
        24 * UPDATE + 13 * blocks(36) * UPPER_BLOCK),
    Job("robust", "update of camera and 5 objects under the Cauchy loss", "us", 1e-3),
    *(Job(f"objects_{n}", f"frame of the multi-object filter, objects: {n}", "us", 0.0) for n in (1, 5, 10)),
    Job("reduce_runnalls", "reduction on SE(3), 1,000 to 10, Runnalls", "ms", 1e-8),
    Job("reduce_symmetric_kl", "reduction on SE(3), 1,000 to 10, symmetric KL", "ms", 1e-8),
    Job("log_density", "log density on SE(3), 10 components, per pose", "ns", 1e-10),
    Job("kl_axisymmetric", "divergence on SO(3) to 1e-6, with an axis of symmetry", "us", 2e-6),
    Job("kl_general", "divergence on SO(3) to 1e-6, general", "us", 2e-6),
    Job("em", "EM on R^6, 7 components, 100,000 samples, per iteration", "ms", 1e-9,
        SAMPLES * COMPONENTS * (WHITEN + MOMENTS), 48.0 * SAMPLES),
    Job("log_density_vectors", "log density on R^6, 7 components, per sample", "ns", 1e-10, COMPONENTS * WHITEN, 48.0),
    Job("fuse_vectors", "product of two Gaussians on R^6", "ns", 1e-9),
    Job("merge_vectors", "merge of two Gaussians on R^6", "ns", 1e-11),
    Job("hybrid", "Gaussian prior and a measurement of two modes on R^6", "us", 1e-10),
]  # fmt: skip
SCALE = {"ns": 1e9, "us": 1e6, "ms": 1e3}
LABELS = {"ours": "posemix", "dense": "dense Eigen", "mrpt": "MRPT", "sophus": "Sophus", "gtsam": "GTSAM",
          "scipy": "SciPy", "filterpy": "FilterPy", "stonesoup": "Stone Soup", "pyrecest": "PyRecEst"}  # fmt: skip


def label(program: str) -> str:
    return LABELS.get(program, program)


def limit_seconds(job: Job, limits: dict[str, dict[str, float]]) -> float:
    """The least time by peak operations or by bytes from the cache they fit into; zero where none is stated."""
    if not limits or not job.operations:
        return 0.0
    peak = max(limits["flops"].values())
    level = "l1" if job.bytes < 24e3 else "l2" if job.bytes < 1e6 else "memory"
    return max(job.operations / peak, job.bytes / limits["bytes"][level])


def ratio(peer: list[float], ours: list[float]) -> tuple[float, float]:
    """Median over rounds of peer's time over ours, and half the range between its quartiles."""
    ratios = sorted(p / o for p, o in zip(peer, ours, strict=True))
    quartiles = statistics.quantiles(ratios, n=4, method="inclusive") if len(ratios) > 1 else [ratios[0]] * 3
    return statistics.median(ratios), (quartiles[2] - quartiles[0]) / 2


def time_text(job: Job, seconds: float) -> str:
    if not seconds:
        return "-"
    value = seconds * SCALE[job.unit]
    return f"{value:.3g} {job.unit}" if value < 1000 else f"{value:,.0f} {job.unit}"


def ratio_text(peer: list[float], ours: list[float]) -> str:
    factor, noise = ratio(peer, ours)
    digits = 2 if factor < 10 else 1 if factor < 100 else 0
    text = f"{factor:,.{digits}f}"
    return f"{text} ± {noise:,.{digits}f}" if len(ours) > 2 else text  # no quartiles of fewer rounds


HEAD = ["work", "ours", "best peer", "peer / ours", "dense Eigen", "dense / ours", "limit", "ours / limit"]
PAIRS_HEAD = ["work", "program", "time", "time / ours", "difference"]


def rows(record: dict[str, Any]) -> list[list[str]]:
    result = []
    for job in JOBS:
        times: dict[str, list[float]] = record["seconds"].get(job.name, {})
        if "ours" not in times:
            continue
        ours = statistics.median(times["ours"])
        peers = {n: t for n, t in times.items() if n not in ("ours", "dense")}
        best = min(peers, key=lambda name: statistics.median(peers[name]), default="")
        row = [job.work, time_text(job, ours)]
        for name in (best, "dense"):
            if name not in times:
                row += ["-", "-"]
                continue
            who = f" ({label(name)})" if name != "dense" else ""
            row += [time_text(job, statistics.median(times[name])) + who, ratio_text(times[name], times["ours"])]
        limit = limit_seconds(job, record["limits"])
        result.append([*row, time_text(job, limit), f"{ours / limit:.1f}" if limit else "-"])
    return result


def pair_rows(record: dict[str, Any]) -> list[list[str]]:
    """Every program of every job, and how its results differ from ours."""
    result = []
    for job in JOBS:
        times: dict[str, list[float]] = record["seconds"].get(job.name, {})
        differences: dict[str, float] = record["differences"].get(job.name, {})
        if "ours" not in times or len(times) < 2:
            continue
        order = sorted(times, key=lambda name: (name != "ours", statistics.median(times[name])))
        for name in order:
            result.append([job.work if name == "ours" else "", label(name),
                           time_text(job, statistics.median(times[name])),
                           ratio_text(times[name], times["ours"]) if name != "ours" else "1",
                           f"{differences[name]:.0e}" if name != "ours" else ""])  # fmt: skip
    return result


def table(head: list[str], body: list[list[str]]) -> str:
    return "\n".join("| " + " | ".join(cells) + " |" for cells in [head, ["---"] * len(head), *body])


def summary(record: dict[str, Any]) -> str:
    limits = record["limits"]
    text = [f"{record['processor']}, {record['rounds']} rounds by turns; "
            + ", ".join(f"{name} {version}" for name, version in record["versions"].items()) + "."]  # fmt: skip
    if limits:
        peaks = {n: v for n, v in limits["flops"].items() if "chains" not in n}
        text.append("One core: " + ", ".join(f"{v / 1e9:.1f} GFLOP/s {n}" for n, v in peaks.items()) + "; reads "
                    + ", ".join(f"{v / 1e9:.0f} GB/s {n}" for n, v in limits["bytes"].items()) + ".")  # fmt: skip
    return "\n".join(text)
