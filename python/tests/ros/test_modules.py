# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""What the node is made of, without ROS."""

from __future__ import annotations

import runpy
import subprocess
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import posemix as px
import pytest

from posemix import SE3
from posemix.ros import Engine, Image, LiveTransforms, configuration, markdown, parameters, symmetries_of
from posemix.ros.configuration import noise_of_toml
from posemix.ros.parameters import settings_parameters

ROOT = Path(__file__).resolve().parents[3]
SECOND = 1_000_000_000
MUG = SE3(translation=[0.0, 0.0, 0.8])


def image(seconds: float, pose: SE3 | None = MUG, name: str = "mug", **more: Any) -> Image:
    seen = () if pose is None else ([px.ObservationComponent(pose)],)
    one = () if pose is None else (1,)
    return Image(
        round(seconds * SECOND), "camera", more.pop("source", ""), more.pop("arrival_s", 0.0),
        tuple(name for _ in one), tuple(0.5 for _ in one), tuple("camera" for _ in one), seen,
    )  # fmt: skip


def test_every_setting_is_a_parameter_with_a_text() -> None:
    names = [p.name for p in settings_parameters()]
    for setting in (
        "filter.max_hypotheses", "association.gate_probability", "existence.lifetime_s", "existence.object_rate.a",
        "health.register_again_s", "confirming_detections", "motion.model", "motion.noise.covariance",
        "stamped.history_s",
    ):  # fmt: skip
        assert setting in names
    everything = parameters()
    assert len({p.name for p in everything}) == len(everything)
    for parameter in everything:
        assert len(parameter.text) > 5 and "Default" not in parameter.text, parameter
        if parameter.choices and parameter.name not in ("given_covariance",):
            assert parameter.default in parameter.choices


def test_defaults_are_those_of_the_settings() -> None:
    found = configuration({})
    defaults = px.ObjectSlamSettings()
    tracker = found.tracker
    assert tracker.on_sight is not None
    tracker.on_sight = None
    assert tracker == defaults.tracker and found.motion == defaults.motion
    stamped = found.stamped
    assert stamped.on_jump_back == px.StampJump.reset
    stamped.on_jump_back = px.StampJump.refuse
    assert stamped == px.StampedSlamSettings()


def test_settings_are_set() -> None:
    found = configuration({
        "filter.max_hypotheses": 3, "motion.model": "still", "existence.object_rate.a": 2.0,
        "motion.walk.covariance": [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], "stamped.history_s": 2.5,
    })  # fmt: skip
    assert found.tracker.filter.max_hypotheses == 3 and found.motion.model == px.MotionModel.still
    assert found.tracker.existence.object_rate.a == 2.0 and found.stamped.history_s == 2.5
    np.testing.assert_array_equal(found.motion.walk.covariance, np.diag([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"motion.model": "flying"}, "motion.model is 'flying'; expected one of odometry"),
        ({"max_gap": 1.0}, "there is no parameter 'max_gap'"),
        ({"motion.walk.covariance": [1.0, 2.0]}, "motion.walk.covariance has 2 numbers; expected 36"),
        ({"sources": ["a", "a"]}, "sources is"),
        ({"detections.type": "PoseStamped"}, "detections.type is 'PoseStamped'; expected one of Detection3DArray"),
        ({"detections.noise": "mine"}, "noise_file"),
        ({"detections.rotation_sd_deg": 2.0}, "the noise of source 'detections'"),
        ({"classes": ["nut"], "nut.instances": 0}, "nut.instances is 0"),
        ({"queue_size": 0}, "queue_size is 0"),
        ({"transform_timeout_s": 0.0}, "transform_timeout_s is 0.0"),
    ],
)
def test_wrong_parameters_are_named(given: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        configuration(given)


def test_settings_out_of_range_are_refused_before_anything_comes() -> None:
    with pytest.raises(ValueError, match="history_s"):
        Engine(configuration({"stamped.history_s": 0.0}))


def test_noise_of_sources() -> None:
    found = configuration({
        "sources": ["first", "second"], "second.rotation_sd_deg": 2.0, "second.translation_sd_m": 0.01,
        "second.given_covariance": "as_given",
    })  # fmt: skip
    assert [source.name for source in found.sources] == ["", "second"]
    assert found.sources[0].noise == px.default_detector_noise() and found.sources[1].topic == "~/second"
    second = found.sources[1].noise
    assert second.dependence.given_covariance == px.GivenCovariance.as_given and second.dependence.slow is not None
    # White and slow error together are what was given.
    total = np.sqrt(np.diag(second.components[0].covariance + second.dependence.slow.covariance))
    np.testing.assert_allclose(total, [np.radians(2.0)] * 3 + [0.01] * 3, rtol=1e-9)
    assert found.model("cup").detectors == {"second": second}


def test_noise_from_a_file(tmp_path: Path) -> None:
    text = px.default_detector_noise().to_toml("mine")
    assert noise_of_toml(text, "mine", "x.toml").to_toml("mine") == text
    file = tmp_path / "noise.toml"
    file.write_text("[noise.mine]\ncomponents = [{rotation_sd_deg = -1, translation_sd_m = 0.1}]\n")
    with pytest.raises(ValueError, match=r"noise\.toml.*rotation_sd_deg"):
        configuration({"noise_file": str(file), "detections.noise": "mine"})


def test_models_of_classes(tmp_path: Path) -> None:
    half = "[-1,0,0,0, 0,-1,0,0, 0,0,1,0, 0,0,0,1]"
    (tmp_path / "models_info.json").write_text(f'{{"5": {{"diameter": 100, "symmetries_discrete": [{half}]}}}}')
    given = {"classes": ["obj_000005"], "obj_000005.instances": 2, "models_info": str(tmp_path / "models_info.json")}
    found = configuration(given)
    models = found.models(found.symmetries)
    assert [model.id for model in models] == ["obj_000005_1", "obj_000005_2"]
    assert all(len(model.symmetries.elements) == 2 and model.class_id == "obj_000005" for model in models)
    moving = configuration({"classes": ["cup"], "cup.motion": "constant_velocity"}).models({})[0]
    assert isinstance(moving.motion.models[0], px.ConstantVelocityMotion)
    with pytest.raises(ValueError, match="no entry 7 for class 'cup'"):
        configuration({"classes": ["cup"], "cup.bop_id": 7, "models_info": given["models_info"]})


def test_transforms_that_come_out_of_order() -> None:
    buffer = LiveTransforms(10.0)
    stamps = [0, 4, 1, 3, 2]
    for stamp in stamps:
        buffer.take("odom", "base", [0.1 * stamp, 0, 0, 0, 0, 0, 1], stamp * SECOND)
    found = buffer.at("odom", "base", 5 * SECOND // 2, 1.5)
    np.testing.assert_allclose(found.translation, [0.25, 0.0, 0.0], atol=1e-12)
    assert buffer.at("odom", "base", 5 * SECOND // 2, 0.5) is None
    assert buffer.at("odom", "nothing", 0, 1.5) is None
    np.testing.assert_array_equal(buffer.at("odom", "base", 3 * SECOND, 0.1).translation, [0.1 * 3, 0.0, 0.0])


def test_transforms_are_forgotten() -> None:
    buffer = LiveTransforms(5.0)
    for stamp in range(1000):
        buffer.take("odom", "base", [0.01 * stamp, 0, 0, 0, 0, 0, 1], stamp * SECOND // 10)
    assert len(buffer._live["base"]._rows) < 200
    assert buffer.at("odom", "base", 0, 0.2) is None and buffer.at("odom", "base", 96 * SECOND, 0.2) is not None
    # The clock has jumped back: what came before it is not mixed with what comes after.
    buffer.take("odom", "base", [5, 0, 0, 0, 0, 0, 1], 0)
    assert buffer.at("odom", "base", 96 * SECOND, 0.2) is None
    assert buffer.at("odom", "base", 0, 0.2).translation[0] == 5.0


def test_the_engine_bounds_what_it_keeps() -> None:
    engine = Engine(configuration({"motion.model": "still", "replay_images": 10}))
    for i in range(6000):
        engine.add(image(0.1 * i, arrival_s=0.1 * i))
        assert len(engine.ready(0.1 * i)) == 1
    run = engine._run
    assert run is not None and len(run._stamps) <= 4100 and len(run._with_odometry) <= 4100
    assert len(engine._log) == 10 and not run.is_whole and engine.counts.images == 6000


def test_images_that_waited_before_a_jump_are_dropped() -> None:
    engine = Engine(configuration({"camera_frame": "camera", "transform_timeout_s": 5.0}))

    def move(seconds: float) -> None:
        engine.transforms.take("odom", "camera", [0, 0, 0, 0, 0, 0, 1], round(seconds * SECOND))

    move(100.0)
    engine.add(image(100.0))
    engine.add(image(100.3))  # whose transform does not come
    assert len(engine.ready(0.0)) == 1 and engine.waiting == 1
    for i in range(4):  # which may be wrong stamps
        move(20.0 + i)
        engine.add(image(20.0 + i, name="box"))
        assert not engine.ready(0.1) and engine.waiting == 1
    move(24.0)
    engine.add(image(24.0, name="box"))
    found = engine.ready(0.1)
    assert len(found) == 1 and set(found[0].hypotheses) == {"box"} and engine.waiting == 0
    assert engine.counts.resets == 1


def test_images_that_tell_nothing_do_not_stop_the_clock() -> None:
    engine = Engine(configuration({"motion.model": "still", "empty_is_image": False}))
    engine.add(image(0.0))
    assert len(engine.ready(0.0)) == 1
    for i in range(40):
        engine.add(image(100.0 * i, None))
        engine.ready(0.0)
    # More than jump_ahead_s after the filter's last input: five images, and then a new run.
    taken = 0
    for i in range(20):
        engine.add(image(4000.0 + i))
        taken += len(engine.ready(0.0))
    assert taken == 16 and engine.counts.resets == 1


def test_unlike_wrong_stamps_are_no_clock() -> None:
    engine = Engine(configuration({"motion.model": "still"}))
    for seconds in (100.0, -5000.0, 9000.0, -300.0, 50000.0, -77.0, 20.0, 20.0, 20.0, 20.0, 20.0, 20.0):
        engine.add(image(seconds))
        engine.ready(0.0)
    assert engine.counts.resets == 0 and engine.counts.images == 1


def test_several_of_a_class_and_what_has_no_model() -> None:
    engine = Engine(configuration({
        "motion.model": "still", "classes": ["nut"], "nut.instances": 3, "on_sight": False,
    }))  # fmt: skip
    for i in range(5):
        both = [image(0.2 * i, SE3(translation=[x, 0.0, 1.0]), "nut") for x in (-0.2, 0.2)]
        other = image(0.2 * i, MUG, "mug")
        engine.add(Image(
            both[0].stamp_ns, "camera", "", 0.0, ("nut", "nut", "mug"), (0.5, 0.6, 0.9), ("camera",) * 3,
            (*both[0].components, *both[1].components, *other.components),
        ))  # fmt: skip
        found = engine.ready(0.0)
    assert set(found[-1].hypotheses) == {"nut_1", "nut_2"} and found[-1].classes["nut_2"] == "nut"
    assert engine.counts.ignored == 5


def test_symmetries_that_are_no_group_name_the_class() -> None:
    turn = SimpleNamespace(
        translation=SimpleNamespace(x=0.0, y=0.0, z=0.0), rotation=SimpleNamespace(x=0.0, y=0.0, z=0.3, w=0.95)
    )
    entry = SimpleNamespace(class_id="cup", symmetries_discrete=[turn], symmetries_continuous=[])
    with pytest.raises(ValueError, match="symmetries of 'cup'"):
        symmetries_of(SimpleNamespace(objects=[entry]))


def test_the_document_has_all_parameters() -> None:
    text = (ROOT / "docs" / "ros.md").read_text(encoding="utf-8")
    begin, end = "<!-- parameters: posemix.ros.markdown() -->\n", "<!-- end -->"
    assert text.split(begin)[1].split(end)[0].strip() == markdown().strip()


def test_the_program_says_what_to_install() -> None:
    code = "import sys; sys.modules['rclpy'] = None; from posemix.ros.__main__ import main; sys.exit(main([]))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1 and "source /opt/ros" in done.stderr and "vision-msgs" in done.stderr


def test_the_launch_file_starts_the_program_with_the_parameters(monkeypatch: pytest.MonkeyPatch) -> None:
    """Over stand-ins that keep what they were given, since launch is no package on PyPI."""

    class Kept(SimpleNamespace):
        def __init__(self, *args: Any, **named: Any) -> None:
            super().__init__(args=args, **named)

    for name, classes in {
        "launch": ["LaunchDescription"], "launch.actions": ["DeclareLaunchArgument", "ExecuteProcess"],
        "launch.conditions": ["IfCondition"], "launch.substitutions": ["LaunchConfiguration", "PythonExpression"],
    }.items():  # fmt: skip
        module = ModuleType(name)
        for cls in classes:
            setattr(module, cls, Kept)
        monkeypatch.setitem(sys.modules, name, module)
    made = runpy.run_path(str(ROOT / "examples" / "ros" / "posemix.launch.py"))["generate_launch_description"]()
    declared, bag, program, player = made.args[0]
    assert Path(declared.default_value).exists() and bag.default_value == ""
    assert program.cmd[:3] == ["posemix-ros", "--ros-args", "--params-file"] and "bag" in player.cmd
