# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The package has the names and signatures that docs/api/python.txt promises."""

import importlib.util
import sys
from pathlib import Path

import posemix as px

TOOLS = Path(__file__).resolve().parents[2] / "tools"
sys.path.append(str(TOOLS / "api"))


def tool():
    spec = importlib.util.spec_from_file_location("api_listing", TOOLS / "api_listing.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_package_is_as_listed(capsys):
    status = tool().main(["python"])
    assert status == 0, capsys.readouterr().out


def test_the_listing_has_compiled_and_python_names_with_their_arguments():
    from python_names import public_names

    lines = set(public_names("posemix"))
    assert "posemix.SO3.exp(cls: 'type[Self]', xi: 'npt.ArrayLike', *, threads: 'int' = 1) -> 'Self'" in lines
    assert "posemix.ReductionSettings.max_components: int (may be assigned)" in lines
    assert any(line.startswith("posemix.fit_existence(counts: ") for line in lines)
    assert {f"posemix.TrackHealth.{health.name}" for health in px.TrackHealth} <= lines


def test_a_changed_signature_is_noticed(monkeypatch):
    from python_names import public_names

    before = sorted(public_names("posemix"))
    monkeypatch.setattr(px, "fuse", lambda a: a)
    monkeypatch.setattr(px.fuse, "__module__", "posemix")
    errors = tool().compare(before, sorted(public_names("posemix")), "tools/api_listing.py python")
    assert any(line.startswith("gone: posemix.fuse(") for line in errors)
    assert any(line.startswith("new: posemix.fuse(a)") for line in errors)
