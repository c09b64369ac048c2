#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Tests of tools/dope_table.py: the pixel metric and the search for pairs."""

import importlib.util
import math
import tempfile
import unittest
from pathlib import Path

TOOL = Path(__file__).resolve().parents[2] / "tools" / "dope_table.py"
SPEC = importlib.util.spec_from_file_location("dope_table", TOOL)
dope_table = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(dope_table)

CAMERA = (1000.0, 1000.0, 320.0, 240.0)
CORNERS = [(x, y, z) for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (-0.1, 0.1)] + [(0.0, 0.0, 0.0)]


class PixelMetric(unittest.TestCase):
    def test_quarter_turn(self):
        half = math.sqrt(0.5)
        point = dope_table.rotate((0.0, 0.0, half, half), (1.0, 2.0, 3.0))
        for actual, expected in zip(point, (-2.0, 1.0, 3.0)):
            self.assertAlmostEqual(actual, expected, places=12)

    def test_projection(self):
        self.assertEqual(dope_table.project(CAMERA, [0.1, -0.2, 2.0, 0, 0, 0, 1], (0, 0, 0)), (370.0, 140.0))
        self.assertIsNone(dope_table.project(CAMERA, [0, 0, -1.0, 0, 0, 0, 1], (0, 0, 0)))

    def test_median_over_frames_and_points(self):
        truth = {k: [0.0, 0.0, 1.0, 0, 0, 0, 1] for k in range(5)}
        self.assertEqual(dope_table.pixel_metric(truth, truth, CAMERA, CORNERS), 0.0)
        moved = {k: [0.01, 0.0, 1.0, 0, 0, 0, 1] for k in range(3)}
        self.assertAlmostEqual(dope_table.pixel_metric(moved, truth, CAMERA, [(0.0, 0.0, 0.0)]), 10.0)

    def test_estimates_behind_the_camera_count_as_infinitely_wrong(self):
        truth = {0: [0.0, 0.0, 1.0, 0, 0, 0, 1]}
        behind = {0: [0.0, 0.0, -1.0, 0, 0, 0, 1]}
        self.assertEqual(dope_table.pixel_metric(behind, truth, CAMERA, CORNERS), math.inf)


class Pairs(unittest.TestCase):
    def test_found_from_both_folders(self):
        with tempfile.TemporaryDirectory() as folder:
            data = Path(folder)
            experiments = data / "slam-super-6d" / "experiments" / "ycbv"
            (experiments / "inference" / "box" / "Initial").mkdir(parents=True)
            (experiments / "inference" / "box" / "Initial" / "0007.txt").touch()
            self.assertEqual(dope_table.experiments_of(data), experiments)
            self.assertEqual(dope_table.experiments_of(data / "slam-super-6d"), experiments)
            self.assertEqual(dope_table.find_pairs(experiments), [("box", "0007")])
            with self.assertRaises(SystemExit):
                dope_table.experiments_of(experiments)

    def test_variants(self):
        self.assertEqual(dope_table.read_variant("a b: x=1 y=2"), ("a b", ["x=1", "y=2"]))
        self.assertEqual(dope_table.read_variant("default:"), ("default", []))


if __name__ == "__main__":
    unittest.main()
