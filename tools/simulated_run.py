# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""A simulated recording and what `posemix slam` made of it."""

import json


class Run:
    """One simulated recording and what `posemix slam` made of it."""

    def __init__(self, recording, results):
        self.recording = recording
        self.trace = json.loads((results / "trace.json").read_text(encoding="utf-8"))
        self.metrics = json.loads((results / "metrics.json").read_text(encoding="utf-8"))
        self.stamps = self.trace["stamps_s"]

    def object(self, name):
        return self.trace["objects"][name]

    def truth(self, name):
        """T_world_object by frame, None where the object is not there."""
        path = self.recording / f"world_truth_{name}.tum"
        if not path.exists():
            return self.object(name)["world"]["truth"]
        return self.poses(path)

    def poses(self, path):
        """Of a TUM file, by frame."""
        poses = {}
        for line in path.read_text(encoding="utf-8").splitlines():
            if line and not line.startswith("#"):
                values = [float(word) for word in line.split()]
                poses[round(values[0], 6)] = values[1:]
        return [poses.get(round(stamp, 6)) for stamp in self.stamps]

    def relative_truth(self, name):
        """T_camera_object by frame."""
        return self.poses(self.recording / f"truth_{name}.tum")

    def true_objects(self):
        return sorted(path.stem[len("truth_"):] for path in self.recording.glob("truth_*.tum"))
