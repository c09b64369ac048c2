# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Files of poses, models and outcomes of other tools: round trips."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import posemix as px
import pytest


def test_object_poses(tmp_path: Path) -> None:
    poses = {"mug": px.SE3(translation=[1.0, 0, 0]), "box": px.SE3(px.SO3.exp([0.1, 0, 0]))}
    px.write_object_poses(tmp_path / "objects.txt", poses)
    again = px.read_object_poses(tmp_path / "objects.txt")
    assert set(again) == set(poses)
    assert all(again[id].is_approx(poses[id], 1e-11) for id in poses)


def test_bop(tmp_path: Path) -> None:
    turn = px.SO3.exp([0.1, 0.2, 0.3])
    numbers = " ".join(f"{v:.17g}" for v in turn.matrix().reshape(-1))
    (tmp_path / "results.csv").write_text(
        "scene_id,im_id,obj_id,score,R,t,time\n"
        f"1,7,5,0.9,{numbers},10 20 800,0.1\n"
        f"1,8,5,0.8,{numbers},11 20 800,0.1\n"
    )
    rows = px.read_bop_rows(tmp_path / "results.csv")
    assert len(rows) == 2 and rows.image.tolist() == [7, 8] and rows.score.tolist() == [0.9, 0.8]
    assert rows.poses[0].is_approx(px.SE3(turn, [0.01, 0.02, 0.8]), 1e-9)
    models = {
        "3": {
            "diameter": 100.0, "min_x": -10, "min_y": -20, "min_z": -30, "size_x": 20, "size_y": 40, "size_z": 60,
            "symmetries_discrete": [[-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]],
        }
    }  # fmt: skip
    (tmp_path / "models_info.json").write_text(json.dumps(models))
    model = px.read_bop_models(tmp_path / "models_info.json")[3]
    assert model.diameter_m == pytest.approx(0.1)
    assert model.symmetries == px.SymmetryGroup.from_bop(models["3"])
    assert model.box is not None
    np.testing.assert_allclose(model.box.corners().max(axis=0), [0.01, 0.02, 0.03])
    assert px.read_bop_model(tmp_path / "models_info.json", 3).symmetries == model.symmetries
    assert px.read_symmetry_file(tmp_path / "models_info.json")[3] == model.symmetries
    with pytest.raises(ValueError, match="results.csv:2"):
        text = (tmp_path / "results.csv").read_text().replace("0.9,", "high,")
        (tmp_path / "results.csv").write_text(text)
        px.read_bop_rows(tmp_path / "results.csv")


def test_grasp_outcomes(tmp_path: Path) -> None:
    poses = [f"{p}_{c}" for p in ("est", "gt") for c in ("tx", "ty", "tz", "qx", "qy", "qz", "qw")]
    header = ",".join(["scene_id", "im_id", "obj_id", "score", *poses, "grasp_wide"])
    row = "1,2,3,0.5,0,0,1,0,0,0,1,0,0,1.1,0,0,0,1,"
    (tmp_path / "set_net.csv").write_text(f"{header}\n{row}1\n{row.replace('1,2,', '1,3,', 1)}\n")
    outcomes = px.read_grasp_outcomes(tmp_path)
    assert outcomes.grippers == ["wide"]
    assert [t.outcomes for t in outcomes.trials] == [[True], [None]]
    assert outcomes.trials[0].estimator == "net" and outcomes.trials[1].image == 3
    assert outcomes.truths.translation[:, 2].tolist() == [1.1, 1.1]
