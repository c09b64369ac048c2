# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Settings behave like dataclasses, and no assignment is lost."""

from __future__ import annotations

import copy
import gc
import inspect
import pickle
from unittest.mock import Mock

import numpy as np
import posemix as px
import pytest


def settings_classes() -> list[type]:
    named = vars(px).items()
    return [c for name, c in named if name.endswith("Settings") and inspect.isclass(c)]


@pytest.mark.parametrize("cls", settings_classes())
def test_defaults_are_documented_and_copies_equal(cls: type) -> None:
    made = cls()
    assert "Attributes\n----------" in cls.__doc__
    for other in (copy.copy(made), copy.deepcopy(made), pickle.loads(pickle.dumps(made))):
        assert other == made and repr(other) == repr(made)
    with pytest.raises(TypeError, match="has no setting 'nothing'"):
        cls(nothing=1)


def test_values_are_taken_and_checked() -> None:
    merge = px.MergeSettings(rule=px.MergeRule.moment_matched)
    settings = px.ReductionSettings(max_components=3, pair=px.PairRule.runnalls, merge=merge)
    assert settings.merge.rule == px.MergeRule.moment_matched
    settings.max_components = 4
    assert settings != px.ReductionSettings() and settings.max_components == 4
    with pytest.raises(TypeError, match="max_components is 'many'; expected int"):
        px.ReductionSettings(max_components="many")
    with pytest.raises(TypeError, match="max_components is 'many'; expected int"):
        settings.max_components = "many"


def assignable(value: object) -> list[str]:
    """Names of the properties that have a setter."""
    members = inspect.getmembers(type(value), lambda member: isinstance(member, property) and member.fset)
    return [name for name, _ in members]


def lose_nothing(owner: object, name: str) -> int:
    """Assigns to every part of an attribute; the owner must change, or the assignment raise. The number of parts."""
    value = getattr(owner, name)
    if isinstance(value, list):
        raise AssertionError(f"{type(owner).__name__}.{name} is a list, whose append is lost")
    if isinstance(value, np.ndarray):
        try:
            value[...] = 0.5
        except ValueError:  # read-only
            return 1
        assert (getattr(owner, name) == 0.5).all()
        return 1
    if isinstance(value, tuple):
        return sum(lose_nothing_of(each) for each in value)
    for part in assignable(value):
        try:
            setattr(getattr(owner, name), part, getattr(value, part))
        except AttributeError as error:
            assert "cannot be assigned here" in str(error), f"{type(owner).__name__}.{name}.{part}"
            continue
        part_value = getattr(value, part)
        if isinstance(part_value, (int, float)) and not isinstance(part_value, bool):
            setattr(getattr(owner, name), part, part_value + 1)
            assert getattr(getattr(owner, name), part) == part_value + 1, f"{type(owner).__name__}.{name}.{part}"
            setattr(getattr(owner, name), part, part_value)
    return lose_nothing_of(value)


def lose_nothing_of(owner: object) -> int:
    return 1 + sum(lose_nothing(owner, name) for name in assignable(owner))


def with_all_parts() -> list[object]:
    noise = px.SimulationNoise()
    thing = px.SimulationObject(id="mug", noise=[noise], claimed=[noise], slow=px.SimulationSlowError())
    config = px.SimulationConfig(objects=[thing], claimed_odometry=px.SimulationSd())
    component = px.NoiseComponent(run_length=3.0)
    model = px.ObjectModel(id="mug", independent_start=np.eye(6))
    dependence = px.NoiseDependence(slow=px.SlowError(correlation_time_s=2.0), common=np.eye(6))
    trackers = [px.MultiObjectSlamSettings(), px.GaussianSumSettings(), px.ParticleFilterSettings()]
    return [config, component, model, dependence, *(px.ObjectSlamSettings(tracker=tracker) for tracker in trackers)]


OWNERS = [*(cls() for cls in settings_classes()), *with_all_parts()]


@pytest.mark.parametrize("owner", OWNERS, ids=lambda owner: type(owner).__name__)
def test_no_assignment_is_lost(owner: object) -> None:
    assert lose_nothing_of(owner) > 1


def test_a_tracker_is_assigned_in_place() -> None:
    settings = px.ObjectSlamSettings()
    settings.tracker.filter.max_hypotheses = 2
    assert settings.tracker.filter.max_hypotheses == 2
    assert "max_hypotheses=2" in repr(settings)
    first = settings.tracker
    settings.tracker = px.GaussianSumSettings()
    settings.tracker.reduction.max_components = 5
    assert settings.tracker.reduction.max_components == 5
    first.filter.max_hypotheses = 3  # no longer a part of the settings, but still itself
    assert first.filter.max_hypotheses == 3 and isinstance(settings.tracker, px.GaussianSumSettings)
    settings.tracker = first
    assert settings.tracker.filter.max_hypotheses == 3
    other = copy.copy(settings)
    other.tracker.filter.max_hypotheses = 4
    assert settings.tracker.filter.max_hypotheses == 3 and other != settings


def test_a_method_s_settings_are_assigned_in_place() -> None:
    method = px.find_slam_method("multi_object")
    settings = method.settings()
    settings.tracker.filter.max_hypotheses = 2
    assert settings.tracker.filter.max_hypotheses == 2
    with pytest.raises(AttributeError, match="max_hypotheses cannot be assigned here.*copy.copy"):
        method.tracker.filter.max_hypotheses = 2


def test_settings_within_a_result_cannot_be_assigned() -> None:
    prior = px.ConcentratedGaussian(px.SE3(), np.eye(6))
    job = px.SlamJob("name", "", px.Sequence([0.0]), prior, [px.ObjectModel(id="mug")], px.ObjectSlamSettings())
    with pytest.raises(AttributeError, match="ObjectSlamSettings.tracker cannot be assigned here"):
        job.settings.tracker = px.GaussianSumSettings()
    with pytest.raises(AttributeError, match="MotionSettings.period_s"):
        job.settings.motion.period_s = 1.0
    with pytest.raises(AttributeError, match="MultiObjectSettings.max_hypotheses"):
        job.settings.tracker.filter.max_hypotheses = 2
    with pytest.raises(ValueError, match="read-only"):
        job.settings.motion.noise.covariance[0, 0] = 2.0
    with pytest.raises(AttributeError):
        job.models.append(px.ObjectModel(id="box"))
    with pytest.raises(AttributeError, match="ObjectModel.id"):
        job.models[0].id = "box"
    settings = copy.copy(job.settings)
    settings.tracker.filter.max_hypotheses = 2
    assert job.replace(settings=settings).settings.tracker.filter.max_hypotheses == 2
    assert pickle.loads(pickle.dumps(job.settings)) == job.settings


def test_a_list_of_settings_is_assigned_as_a_whole() -> None:
    config = px.SimulationConfig(objects=[px.SimulationObject(id="mug")])
    with pytest.raises(AttributeError, match="append"):
        config.objects.append(px.SimulationObject(id="box"))
    with pytest.raises(AttributeError, match="SimulationObject.id cannot be assigned here"):
        config.objects[0].id = "cup"
    with pytest.raises(AttributeError, match="SimulationRuns.fraction"):
        config.objects[0].misses.fraction = 0.5
    config.objects = [*config.objects, px.SimulationObject(id="box")]
    assert [each.id for each in config.objects] == ["mug", "box"]


def test_parts_live_as_long_as_they_are_held() -> None:
    config = px.SimulationConfig(objects=[px.SimulationObject(id="a long name " * 10)])
    held, path = config.objects[0], config.path
    config.objects = []
    del config
    gc.collect()
    assert held.id == "a long name " * 10 and path.frames == px.SimulationPath().frames


def test_copies_of_a_noise_model_cannot_be_assigned() -> None:
    noise = px.DetectorNoise([px.NoiseComponent()], px.Clutter(weight=0.1))
    with pytest.raises(AttributeError, match="NoiseComponent.weight cannot be assigned here"):
        noise.components[0].weight = 2.0
    with pytest.raises(AttributeError, match="Clutter.weight"):
        noise.clutter.weight = 0.5
    component = copy.copy(noise.components[0])
    component.weight = 2.0
    assert component.weight == 2.0 and type(component) is px.NoiseComponent
    tracker = px.MultiObjectFilter(px.ConcentratedGaussian(px.SE3(), np.eye(6)), [px.ObjectSensor()])
    with pytest.raises(AttributeError, match="MultiObjectSettings.birth_score"):
        tracker.settings.birth_score = 1.0


def test_an_attribute_is_of_an_object_of_its_class() -> None:
    """Other objects, mocks of the class and objects that were never filled have none."""
    cls = px.MultiObjectSettings
    unmade = cls.__new__(cls)
    for other in (42, Mock(spec=cls), px.FuseSettings(), unmade):
        why = "was not made; a subclass calls" if other is unmade else "incompatible function arguments"
        uses = (cls.max_hypotheses.fget, lambda o: cls.max_hypotheses.fset(o, 3), cls.__repr__, cls.__getstate__)
        for use in uses:
            with pytest.raises(TypeError, match=why):
                use(other)
        assert cls() != other


def test_an_object_is_made_once() -> None:
    made = px.MultiObjectSettings(max_hypotheses=3)
    with pytest.raises(TypeError, match=r"MultiObjectSettings.__init__\(\): the object is made already"):
        made.__init__(max_hypotheses=4)  # type: ignore[misc]
    with pytest.raises(TypeError, match=r"MultiObjectSettings.__setstate__\(\): the object is made already"):
        made.__setstate__({"max_hypotheses": 4})
    assert made.max_hypotheses == 3
    with pytest.raises(TypeError, match="incompatible function arguments"):
        px.ToleranceBox.__init__(42)
    # What cannot be made is nothing, and can be made after all.
    late = px.MultiObjectSettings.__new__(px.MultiObjectSettings)
    with pytest.raises(TypeError, match="expected int"):
        late.__init__(max_hypotheses="many")  # type: ignore[misc, arg-type]
    with pytest.raises(TypeError, match="was not made"):
        _ = late.max_hypotheses
    late.__init__(max_hypotheses=5)  # type: ignore[misc]
    assert late.max_hypotheses == 5


def test_nobody_sees_an_object_before_it_is_whole() -> None:
    """Code of a value that is converted could keep a part of an object that then is not made."""
    seen = []

    class Curious:
        def __init__(self, owner: object) -> None:
            self.owner = owner

        def __float__(self) -> float:
            try:
                seen.append(self.owner.unit)
            except TypeError as error:
                seen.append(str(error))
            raise ValueError("no")

        __index__ = __float__

    made = px.EmSettings.__new__(px.EmSettings)
    with pytest.raises((TypeError, ValueError)):
        made.__init__(unit=np.full(40, 7.0), max_sd=Curious(made))  # type: ignore[misc, arg-type]
    assert seen and all("was not made" in str(each) for each in seen)


@pytest.mark.parametrize("inner", [{}, {"max_sd": "wide"}])
def test_an_object_that_its_own_values_make_is_whole(inner: dict[str, object]) -> None:
    made = px.EmSettings.__new__(px.EmSettings)

    class Meddling:
        def __float__(self) -> float:
            try:
                made.__init__(**inner)  # type: ignore[misc, arg-type]
            except TypeError:
                return 2.0
            return 1.0

    outer = {"unit": np.full(40, 7.0), "max_sd": Meddling()}
    if inner:
        made.__init__(**outer)  # type: ignore[misc, arg-type]
        assert made == px.EmSettings(unit=np.full(40, 7.0), max_sd=2.0)
    else:
        with pytest.raises(TypeError, match="the object is made already"):
            made.__init__(**outer)  # type: ignore[misc, arg-type]
        assert made == px.EmSettings()


def test_an_array_of_any_size_is_a_copy() -> None:
    """It moves when another is assigned, and whoever held it would read what is there by then."""
    settings = px.EmSettings(unit=np.full(40, 7.0))
    held = settings.unit
    settings.unit = np.zeros(3)
    others = [np.full(40, 3.25) for _ in range(5)]
    assert len(others) == 5 and held.tolist() == [7.0] * 40
    with pytest.raises(ValueError, match="read-only"):
        settings.unit[0] = 1.0
    settings.unit = [1.0, 2.0]
    assert settings.unit.tolist() == [1.0, 2.0]


def test_pickles_share_the_names_of_fields() -> None:
    one, other = (px.MultiObjectSettings().__getstate__() for _ in range(2))
    assert all(a is b for a, b in zip(one, other, strict=True))


def test_keys_that_are_no_names_are_refused() -> None:
    with pytest.raises(TypeError, match=r"has no setting '\\ud800'"):
        px.MultiObjectSettings(**{"\ud800": 1})
    late = px.MultiObjectSettings.__new__(px.MultiObjectSettings)
    with pytest.raises(TypeError, match="has no setting 3"):
        late.__setstate__({3: 1})


def test_results_are_made_of_whole_states() -> None:
    corners = px.CornerSighting.__new__(px.CornerSighting)
    with pytest.raises(TypeError, match="a state without 'stamp_s'"):
        corners.__setstate__({})
    body = px.ConcentratedGaussian(px.SE3(), 1e-4 * np.eye(6))
    slam = px.StampedSlam(body, [px.ObjectModel(id="mug")])
    slam.add(px.Observation([px.ObservationComponent(px.SE3(translation=[0, 0, 1]))], object="mug"))
    found = slam.finish()
    assert found is not None and pickle.loads(pickle.dumps(found)) == found
