# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Settings behave like dataclasses."""

from __future__ import annotations

import copy
import inspect
import pickle

import pytest

import posemix
from posemix import MergeRule, MergeSettings, PairRule, ReductionSettings


def settings_classes() -> list[type]:
    named = vars(posemix).items()
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
    merge = MergeSettings(rule=MergeRule.moment_matched)
    settings = ReductionSettings(max_components=3, pair=PairRule.runnalls, merge=merge)
    assert settings.merge.rule == MergeRule.moment_matched
    settings.max_components = 4
    assert settings != ReductionSettings() and settings.max_components == 4
    with pytest.raises(TypeError, match="max_components is 'many'; expected int"):
        ReductionSettings(max_components="many")
