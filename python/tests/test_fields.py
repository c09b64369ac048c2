# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Every field of the public structs of settings and results is in Python, in files and in the documents."""

from __future__ import annotations

import inspect
import re
from pathlib import Path

import posemix as px
import pytest

ROOT = Path(__file__).resolve().parents[2]

# Endings of the names of structs that are bound.
KINDS = (
    "Settings", "Report", "Result", "Estimate", "Fit", "Metrics", "Errors", "Selection", "Record", "Loss", "Reduction",
    "Moments", "Fusion", "Conversion", "Hypothesis", "Alternative", "Snapshot", "Candidate", "Association", "Forecast",
    "Timing", "Grasp", "Model", "Job", "Sequence", "Recording", "Input", "Samples", "File", "Outcomes", "Trial", "Box",
    "Pose", "Bin", "Calibration", "Consensus", "Error", "Method", "Run", "Mode", "Correlation", "Validation", "Noise",
    "Frames", "Window", "Region",
)  # fmt: skip

# Classes of another name, with the names of fields that differ.
OTHER_NAMES: dict[str, tuple[str, dict[str, tuple[str, ...]]]] = {
    "ProjectedFusion": ("FuseResult", {}),
    "MixtureFusion": ("FuseResult", {"mixture": ("density",), "log_evidence": ("log_overlap",)}),
    "MixtureFile": ("MixtureFile", {"frames": ("from_frame", "to_frame"), "warnings": ()}),  # they become warnings
    "SimulatedSequence": (
        "SimulatedSequence", dict.fromkeys(("stamps_ns", "odometry", "camera_truth", "objects"), ("sequence",)),
    ),
    "SlamMethod": ("SlamMethod", {"restore": ()}),  # a function that files need
    "MergeResult": ("MergeResult", {"component": ("density", "log_weight")}),
}

# Structs without a class, and why.
WITHOUT_CLASS = {
    "MeanSettings": "lie.weighted_mean always iterates to rounding",
    "MeanResult": "lie.weighted_mean returns the mean and warns",
    "IteratedUpdateSettings": "a step of the filter, not called from Python",
    "CauchySettings": "a step of the filter; GaussianSumSettings.cauchy_scale sets it",
    "UpdateResult": "a step of the filter, not called from Python",
    "RotationQuadratureSettings": "exact divergences on SO(3) are not bound",
    "ProjectedMoments": "`moments` returns a density with them",
    "DistributionMoments": "ProjectedGaussian has mean and covariance",
    "TranslationMoments": "an intermediate result of the composition",
    "EmGaussianMoments": "an intermediate result of EM",
    "EmModel": "how a kind of density is fitted, a customisation point of C++",
    "NoiseEmSettings": "a step of fit_noise, which sets it from NoiseFitSettings",
    "NoiseModesFit": "a step of fit_noise, whose NoiseFit has its parts",
    "FuzzReport": "a tool of the tests",
    "MeanWithError": "a step of the studies",
    "NoiseAtPose": "a step of the filters",
    "OutlinedBox": "a part of pictures",
    "DatasetSequence": "recordings of other packages are read by the program",
    "SimulatedPose": "SimulatedSequence has arrays of poses",
    "StampedPose": "StampedPoses has arrays",
    "ScoredPose": "BopRows has arrays",
    "OdometryRecording": "fit_odometry_noise takes a Sequence",
    "BopSelection": "rows of a result file are selected with numpy",
}

# Structs that a sequence file or a simulation file sets: the document of the file, and keys of another name.
IN_FILES: dict[str, tuple[str, dict[str, str]]] = {
    "MultiObjectSettings": ("formats.md", {"merge_rotation_rad": "merge_rotation_deg"}),
    "MultiObjectSlamSettings": ("formats.md", {}),
    "AssociationSettings": ("formats.md", {}),
    "SmoothingSettings": (
        "formats.md",
        {"lag_frames": "smooth_lag", "passes": "smooth_passes", "least_probability": "smooth_least_probability"},
    ),
    "GaussianSumSettings": ("formats.md", {}),
    "ReductionSettings": ("formats.md", {"pair": "pair_rule"}),
    "MergeSettings": ("formats.md", {"rule": "merge_rule", "jacobian": "transport_jacobian"}),
    "ParticleFilterSettings": (
        "formats.md",
        {
            "seed": "particle_seed", "object_walk": "particle_walk_rotation_sd_deg",
            "kernel": "particle_kernel_rotation_sd_deg", "hypotheses": "particle_hypotheses",
        },
    ),
    "MotionSettings": ("formats.md", {"walk": "noise"}),
    "ProcessNoise": ("formats.md", {"covariance": "rotation_sd_deg"}),
    "ObjectModel": ("formats.md", {"independent_start": "start", "class_id": "class"}),
    "ObjectSlamSettings": ("formats.md", {}),
    "NoiseComponent": ("formats.md", {"update_covariance": "update"}),
    "NoiseDependence": ("formats.md", {}),
    "Clutter": ("formats.md", {}),
    "SimulationSwing": ("simulation.md", {}),
    "SimulationPath": ("simulation.md", {}),
    "SimulationSd": ("simulation.md", {"rotation_rad": "rotation_sd_deg", "translation_m": "translation_sd_m"}),
    "SimulationNoise": (
        "simulation.md",
        {"sd": "rotation_sd_deg", "offset_rotation_rad": "rotation_deg", "offset_translation_m": "translation_m"},
    ),
    "SimulationRuns": ("simulation.md", {}),
    "SimulationFlips": ("simulation.md", {"runs": "fraction", "rotation_rad": "rotation_deg"}),
    "SimulationOutliers": ("simulation.md", {"runs": "fraction"}),
    "SimulationObject": ("simulation.md", {"rotation_rad": "rotation_deg", "claimed": "claimed_noise"}),
    "SimulationConfig": ("simulation.md", {"path": "camera", "claimed_odometry": "motion"}),
}  # fmt: skip

# Fields of these structs that no file sets, and why.
NOT_IN_FILES = {
    "MultiObjectSettings.has_odometry": "follows from the motion model",
    "GaussianSumSettings.first_object": "follows from the motion model",
    "GaussianSumSettings.reduction": "its fields are keys of the same table",
    "ReductionSettings.merge": "its fields are keys of the same table",
    "ReductionSettings.bound_loss": "results of a run do not hold the bounds",
    "MergeSettings.max_iterations": "a limit of the arithmetic that no reduction reaches",
    "MergeSettings.tolerance": "a limit of the arithmetic",
    "ParticleFilterSettings.merge": "merge_rule and transport_jacobian of the same table",
    "MultiObjectSlamSettings.filter": "its fields are keys of the table [filter]",
    "MultiObjectSlamSettings.association": "its fields are keys of the same table",
    "ObjectSlamSettings.tracker": "filter.method chooses it",
    "ObjectSlamSettings.record_hypotheses": "output.trace_hypotheses asks for them",
}


def without_comments(text: str) -> str:
    return re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.DOTALL)


def closing(text: str, start: int) -> int:
    """Index of the brace that closes the one at `start`."""
    depth = 0
    for i in range(start, len(text)):
        depth += {"{": 1, "}": -1}.get(text[i], 0)
        if depth == 0:
            return i
    raise ValueError("a brace is not closed")


def statements(body: str) -> list[str]:
    """Declarations of a struct; blocks, as bodies of functions and initialisers, are replaced by {}."""
    flat, i = "", 0
    while i < len(body):
        if body[i] == "{":
            i = closing(body, i)
            flat += "{}" if body[i + 1 : i + 2] in (";", ",") else "{};"
        else:
            flat += body[i]
        i += 1
    return [" ".join(part.split()) for part in flat.split(";")]


def field_of(statement: str) -> str | None:
    """Name of the data member that a statement declares."""
    declared = re.split(r"[={]", statement, maxsplit=1)[0].strip()
    skipped = r"(using|static|enum|struct|class|friend|template|typedef|explicit|public|private)\b|~|.*\boperator\b"
    if not declared or re.match(skipped, declared) or "(" in declared:
        return None
    found = re.fullmatch(r"[\w:<>,&*\s.]+[\s&*>](\w+)(\[\w*\])?", declared)
    return found[1] if found else None


def structs() -> dict[str, list[str]]:
    """Fields of the public structs by the struct's name."""
    found: dict[str, list[str]] = {}
    for path in sorted((ROOT / "include" / "posemix").rglob("*.hpp")):
        text = without_comments(path.read_text(encoding="utf-8"))
        for match in re.finditer(r"\bstruct (\w+)(?:<[^{;]*>)?(?: final)?\s*\{", text):
            body = text[match.end() : closing(text, match.end() - 1)]
            fields = [field_of(statement) for statement in statements(body)]
            found[match[1]] = [name for name in fields if name is not None]
    return found


STRUCTS = structs()
BOUND = sorted(name for name in STRUCTS if name.endswith(KINDS) and name not in WITHOUT_CLASS)


def test_the_parser_reads_fields_and_nothing_else() -> None:
    text = "double a = 0.0; std::vector<int> b{1, 2}; int f() const { return 1; } std::array<bool, 6> c; using T = int;"
    assert [field_of(s) for s in statements(text) if field_of(s)] == ["a", "b", "c"]
    assert STRUCTS["ModeForecast"] == ["probability", "right"]
    assert "unit" in STRUCTS["EmSettings"] and len(STRUCTS["MultiObjectSettings"]) > 15


def attributes(cls: type) -> set[str]:
    names = {name for name in dir(cls) if not name.startswith("_")}
    return names | set(inspect.get_annotations(cls))


@pytest.mark.parametrize("name", BOUND)
def test_python_has_every_field(name: str) -> None:
    public, renamed = OTHER_NAMES.get(name, (name, {}))
    cls = getattr(px, public, None)
    assert cls is not None, f"posemix has no class {public} for the struct {name}"
    known = attributes(cls)
    for field in STRUCTS[name]:
        for attribute in renamed.get(field, (field,)):
            assert attribute in known, f"posemix.{public} lacks {name}::{field}"


@pytest.mark.parametrize("name", sorted(n for n in BOUND if n.endswith("Settings")))
def test_settings_have_only_fields_of_the_struct(name: str) -> None:
    made = getattr(px, name)()
    assert set(made.__getstate__()) <= set(STRUCTS[name])


def test_exceptions_are_of_structs_that_exist() -> None:
    assert set(WITHOUT_CLASS) <= set(STRUCTS) and set(OTHER_NAMES) <= set(STRUCTS)


FILED = [(name, field) for name in IN_FILES for field in STRUCTS[name] if f"{name}.{field}" not in NOT_IN_FILES]


@pytest.mark.parametrize(("name", "field"), FILED, ids=lambda part: part)
def test_files_and_their_document_have_every_setting(name: str, field: str) -> None:
    page, other_keys = IN_FILES[name]
    key = other_keys.get(field, field)
    readers = [*(ROOT / "src" / "config").glob("*.cpp"), ROOT / "include/posemix/filter/multi_object_ranges.hpp"]
    sources = "".join(path.read_text() for path in readers)
    assert f'"{key}"' in sources, f"no file sets {name}::{field}: src/config does not read the key '{key}'"
    text = (ROOT / "docs" / page).read_text()
    assert re.search(rf"`[^`\n]*\b{key}\b[^`\n]*`", text), f"docs/{page} lacks the key '{key}' of {name}::{field}"


def test_exceptions_of_files_are_of_fields_that_exist() -> None:
    fields = {f"{name}.{field}" for name in IN_FILES for field in STRUCTS[name]}
    assert set(NOT_IN_FILES) <= fields
    assert {f"{name}.{field}" for name, (_, keys) in IN_FILES.items() for field in keys} <= fields
