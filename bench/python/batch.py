#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Batches of a million elements: the Python package compared with C++ in the same run.

usage: bench/python/batch.py build/release/bench/bench_batch     with the package installed
"""

import json
import subprocess
import sys
import time

import numpy as np

from posemix import SE3, SO3

COUNT = 1_000_000
REPEATS = 9


def median_ms(function):
    times = []
    for _ in range(REPEATS):
        begin = time.perf_counter()
        function()
        times.append(1e3 * (time.perf_counter() - begin))
    return float(np.median(times))


def main(program):
    run = [program, "--benchmark_format=json", f"--benchmark_repetitions={REPEATS}"]
    run += [f"--benchmark_filter=Batch.*/{COUNT}$"]
    found = json.loads(subprocess.run(run, check=True, capture_output=True, text=True).stdout)
    cpp = {b["run_name"]: b["real_time"] / 1e3 for b in found["benchmarks"] if b.get("aggregate_name") == "median"}
    print(f"{'':24}{'C++ [ms]':>10}{'Python [ms]':>13}{'ratio':>8}")
    for group in (SO3, SE3):
        xi = np.random.default_rng(7).normal(size=(COUNT, group.DOF))
        x = group.exp(xi)
        y = x[::-1]
        calls = {
            "Exp": lambda g=group, v=xi: g.exp(v),
            "Log": x.log,
            "LeftJacobian": lambda g=group, v=xi: g.left_jacobian(v),
            "LeftJacobianInverse": lambda g=group, v=xi: g.left_jacobian_inverse(v),
            "Compose": lambda a=x, b=y: a * b,
        }
        for name, call in calls.items():
            peer = cpp[f"{name}Batch<{group.__name__}d>/{COUNT}"]
            own = median_ms(call)
            print(f"{group.__name__ + ' ' + name:24}{peer:10.1f}{own:13.1f}{own / peer:8.2f}")


if __name__ == "__main__":
    main(*sys.argv[1:])
