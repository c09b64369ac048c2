#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Run posemix on every pair of object and sequence with DOPE detections, and print a table.

usage: tools/dope_table.py build/release/posemix --data DIR
       tools/dope_table.py build/release/posemix --data DIR \\
           --variant "midway 6: filter.max_components=6" --variant "default:"

A variant is a name, a colon and overrides of the sequence file separated by blanks. Columns, for every variant:
rotation [deg] and position [cm] error (rms) of the camera, of the object in the world and of the object relative to
the camera, the error's squared Mahalanobis distance per degree of freedom (ANEES, 1 when consistent), and the published
pixel metric: the median over the frames with an estimate and 9 points (the corners of the object's cuboid and its
centre) of the distance in the image between estimate and ground truth [px].
"""

import argparse
import concurrent.futures
import itertools
import json
import math
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

VARIANTS = (
    "RIEKF: filter.method=riekf objects.0.noise=gaussian",
    "RIEKF with gate: filter.method=riekf objects.0.noise=gaussian filter.gate_probability=0.999",
    "default:",
)
FIRST_OF_SECOND_CAMERA = "0060"
COLUMNS = ("cam deg", "cam cm", "obj deg", "obj cm", "rel deg", "rel cm", "ANEES", "px")


def experiments_of(data):
    for root in (data, data / "slam-super-6d"):
        if (root / "experiments" / "ycbv").is_dir():
            return root / "experiments" / "ycbv"
    sys.exit(f"tools/dope_table.py: {data}: no folder experiments/ycbv in it")


def find_pairs(experiments):
    files = sorted((experiments / "inference").glob("*/Initial/*.txt"))
    return [(path.parent.parent.name, path.stem) for path in files]


def read_variant(text):
    name, _, overrides = text.partition(":")
    return name.strip(), overrides.split()


def read_camera(path):
    """Focal lengths and principal point, pixels."""
    values = {}
    for line in path.read_text().splitlines():
        key, _, value = line.partition(":")
        values[key.strip()] = value.strip()
    return tuple(float(values[f"Camera.{name}"]) for name in ("fx", "fy", "cx", "cy"))


def read_cuboid(path, name):
    """Corners and centre of the object's box, metres."""
    for item in json.loads(path.read_text())["exported_objects"]:
        if item["class"] == name:
            half = [0.005 * size for size in item["cuboid_dimensions"]]
            corners = itertools.product(*((-h, h) for h in half))
            return [*corners, (0.0, 0.0, 0.0)]
    sys.exit(f"tools/dope_table.py: {path}: no object {name}")


def read_tum(path):
    poses = {}
    for line in path.read_text().splitlines():
        if line and not line.startswith("#"):
            stamp, *pose = map(float, line.split())
            poses[round(1000 * stamp)] = pose
    return poses


def rotate(quaternion, point):
    x, y, z, w = quaternion
    px, py, pz = point
    cx, cy, cz = 2 * (y * pz - z * py), 2 * (z * px - x * pz), 2 * (x * py - y * px)
    return (px + w * cx + y * cz - z * cy, py + w * cy + z * cx - x * cz, pz + w * cz + x * cy - y * cx)


def project(camera, pose, point):
    """Pixels of a point of the object, or None where it lies behind the camera."""
    fx, fy, cx, cy = camera
    x, y, z = (a + b for a, b in zip(rotate(pose[3:], point), pose[:3]))
    return (fx * x / z + cx, fy * y / z + cy) if z > 0 else None


def pixel_metric(estimates, truths, camera, points):
    distances = []
    for stamp, estimate in estimates.items():
        if stamp not in truths:
            continue
        for point in points:
            a, b = project(camera, estimate, point), project(camera, truths[stamp], point)
            distances.append(math.dist(a, b) if a and b else math.inf)
    return statistics.median(distances) if distances else math.nan


def run_pair(program, config, experiments, pair, overrides):
    """The columns of one pair."""
    name, sequence = pair
    with tempfile.TemporaryDirectory(prefix="posemix-dope-") as folder:
        out = Path(folder) / "out"
        command = [program, "slam", config, "--data", experiments.parent.parent, "--out", out, "--quiet",
                   "--set", f"object={name}", "--set", f"sequence={sequence}", "--set", "output.trace_hypotheses=0"]
        for override in overrides:
            command += ["--set", override]
        result = subprocess.run(list(map(str, command)), capture_output=True, text=True)
        if result.returncode != 0:
            return f"exit code {result.returncode}: {result.stderr.strip()}"
        metrics = json.loads((out / "metrics.json").read_text())
        estimates = read_tum(out / f"relative_{name}.tum")
    truths = read_tum(experiments / "inference" / name / "ground_truth" / f"{sequence}_ycb_gt.txt")
    camera = read_camera(experiments / "odom" / ("YCB2.yaml" if sequence >= FIRST_OF_SECOND_CAMERA else "YCB.yaml"))
    points = read_cuboid(experiments / "_ycb_original.json", name)
    errors = metrics["objects"][name]
    return (metrics["camera"]["rotation_rmse_deg"], 100 * metrics["camera"]["position_rmse_m"],
            errors["rotation_rmse_deg"], 100 * errors["position_rmse_m"],
            errors["relative_rotation_rmse_deg"], 100 * errors["relative_position_rmse_m"],
            metrics["consistency"]["relative_anees"][name],
            pixel_metric(estimates, truths, camera, points))


def row_text(head, values):
    return head + " ".join(f"{value:9.2f}" if value < 1e5 else f"{value:9.2g}" for value in values)


def print_variant(name, pairs, rows):
    width = max(len(f"{obj} {sequence}") for obj, sequence in pairs) + 2
    print(f"\n{name}\n" + " " * width + " ".join(f"{column:>9}" for column in COLUMNS))
    good = []
    for (obj, sequence), row in zip(pairs, rows):
        head = f"{obj} {sequence}".ljust(width)
        if isinstance(row, str):
            print(head + "FAILED " + row)
        else:
            good.append(row)
            print(row_text(head, row))
    if good:
        print(row_text("median".ljust(width), map(statistics.median, zip(*good))))
    return len(rows) - len(good)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path, help="the program posemix")
    parser.add_argument("--data", type=Path, required=True, help="the data folder, or its folder slam-super-6d")
    parser.add_argument("--config", type=Path,
                        default=Path(__file__).resolve().parent.parent / "configs" / "ycbv-dope.toml")
    parser.add_argument("--variant", action="append", metavar="NAME: KEY=VALUE ...")
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()

    experiments = experiments_of(arguments.data)
    pairs = find_pairs(experiments)
    failures = 0
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for name, overrides in map(read_variant, arguments.variant or VARIANTS):
            rows = list(pool.map(lambda pair: run_pair(arguments.program.resolve(), arguments.config, experiments,
                                                       pair, overrides), pairs))
            failures += print_variant(name, pairs, rows)
    sys.exit(f"tools/dope_table.py: {failures} runs failed" if failures else 0)


if __name__ == "__main__":
    main()
