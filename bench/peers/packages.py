# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Packages of Python at the jobs of bench/peers: PYTHON packages.py INPUTS RESULTS SECONDS [JOB]...

All calls are for whole arrays where the package has such, so that the interpreter counts little. A line of JSON has the
name of the package, and its results are written to RESULTS/PACKAGE. A package that is not installed is left out, with a
line that says so.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from packages_gtsam import gtsam_jobs
from packages_lie import pytransform3d_jobs, scipy_jobs
from packages_vectors import filterpy_jobs, pyrecest_jobs, sklearn_jobs, stonesoup_jobs

PACKAGES = {
    "gtsam": gtsam_jobs,
    "scipy": scipy_jobs,
    "pytransform3d": pytransform3d_jobs,
    "scikit-learn": sklearn_jobs,
    "filterpy": filterpy_jobs,
    "stonesoup": stonesoup_jobs,
    "pyrecest": pyrecest_jobs,
}
LEAST, MOST = 3, 100  # samples of a job, unless the first takes longer than all of them should


def seconds_of(work: Callable[[], Any]) -> float:
    begin = time.thread_time()
    work()
    return time.thread_time() - begin


def main(inputs: Path, results: Path, seconds: float, only: list[str]) -> None:
    for package, jobs in PACKAGES.items():
        try:
            found = version(package)
        except PackageNotFoundError:
            print(f"packages.py: {package} is not installed", file=sys.stderr)
            continue
        folder = results / package
        folder.mkdir(exist_ok=True)
        for name, (work, output, items) in jobs(inputs).items():
            if only and name not in only:
                continue
            samples = [seconds_of(work)]
            output(work()).astype(float).tofile(folder / f"{name}.f64")
            while samples[0] < seconds and len(samples) < MOST and (len(samples) < LEAST or sum(samples) < seconds):
                samples.append(seconds_of(work))
            line = {"job": name, "program": package, "version": found}
            print(json.dumps({**line, "seconds": [sample / items for sample in samples]}), flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), float(sys.argv[3]), sys.argv[4:])
