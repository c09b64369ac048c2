# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Every field of the public structs of settings and results is in Python."""

from __future__ import annotations

import inspect
import re
from pathlib import Path

import posemix as px
import pytest

ROOT = Path(__file__).resolve().parents[2]

# Classes of another name, with the names of fields that differ.
OTHER_NAMES: dict[str, tuple[str, dict[str, tuple[str, ...]]]] = {
    "ProjectedFusion": ("FuseResult", {}),
    "MixtureFusion": ("FuseResult", {}),
    "MixtureFile": ("MixtureFile", {"frames": ("from_frame", "to_frame"), "warnings": ()}),  # they become warnings
    "SimulatedSequence": (
        "SimulatedSequence",
        dict.fromkeys(("stamps_ns", "odometry", "camera_truth", "objects", "sightings"), ("sequence",)),
    ),
    "Fiducials": (
        "Fiducials",
        {
            "observations": ("sighting", "weights", "poses", "covariances", "stamps", "cameras", "tags"),
            "warnings": (),  # they become warnings
        },
    ),
    "TagMap": ("TagMap", {"remaps": ()}),
    "SlamMethod": ("SlamMethod", {"restore": ()}),  # a function that files need
    # Recordings of frames that hold objects are a part of sequence files.
    "Sequence": ("Sequence", {"known_frames": ()}),
    "MergeResult": ("MergeResult", {"component": ("density", "log_weight")}),
}

# Structs without fields.
EMPTY = {"StaticMotion"}

# Structs without a class, and why.
WITHOUT_CLASS = {
    "UncertainPoses": "arguments of posemix::batch, whose functions take arrays in Python",
    "UncertainPosesResult": "results of posemix::batch",
    "MotionPrediction": "a step of MovingObjectFilter",
    "TrackedPlace": "a step of MultiObjectSlam",
    "MotionState": "a step of MovingObjectFilter",
    "Assignment": "a step of the association of candidates",
    "JointAssociation": "a step of the association of candidates",
    "FrameRecording": "sequence files have the frames that hold objects",
    "TrackedDetection": "a step of object SLAM, whose estimates have existence and health",
    "HypothesisMean": "MultiObjectFilter.hypotheses has the densities",
    "LeadingEstimate": "MultiObjectFilter.object and .relative have the densities",
    "Projection": "CameraModel.project returns pixels",
    "FiducialFolder": "arguments of write_fiducials",
    "FiducialSequenceSettings": "options of posemix fiducials",
    "TagRemap": "read_tag_map reads them for observe_fiducials",
    "TagOdometryNoise": "a step of posemix fiducials",
    "ObservationSequenceFiles": "files that posemix convert writes",
    "MeanSettings": "lie.weighted_mean always iterates to rounding",
    "MeanResult": "lie.weighted_mean returns the mean and warns",
    "IteratedUpdateSettings": "a step of the filter, not called from Python",
    "CauchySettings": "a step of the filter; GaussianSumSettings.cauchy_scale sets it",
    "UpdateResult": "a step of the filter, not called from Python",
    "RotationQuadratureSettings": "exact divergences on SO(3) are not bound",
    "ProjectedMoments": "`moments` returns a density with them",
    "DistributionMoments": "ProjectedGaussian has mean and covariance",
    "TranslationMoments": "an intermediate result of the composition",
    "EmModel": "how a kind of density is fitted, a customisation point of C++",
    "NoiseEmSettings": "a step of fit_noise, which sets it from NoiseFitSettings",
    "NoiseModesFit": "a step of fit_noise, whose NoiseFit has its parts",
    "MeanWithError": "a step of the studies",
    "NoiseAtPose": "a step of the filters",
    "OutlinedBox": "a part of pictures",
    "DatasetSequence": "recordings of other packages are read by the program",
    "SimulatedPose": "SimulatedSequence has arrays of poses",
    "StampedPose": "StampedPoses has arrays",
    "ScoredPose": "BopRows has arrays",
    "OdometryRecording": "fit_odometry_noise takes a Sequence",
    "BopSelection": "rows of a result file are selected with numpy",
    "BopRow": "BopRows has arrays",
    "BopObservationSettings": "rows of a result file are grouped with numpy",
    "ImageGroup": "a list of image ids",
    "SimulatedObject": "SimulatedSequence.sequence has it as an ObjectRecording",
    "SimulatedFrame": "SimulatedSequence.frames and frame_truth have arrays of poses",
    "SimulatedSighting": "SimulatedSequence.sequence has it as an Observation",
    "ErrorOutcome": "fit_tolerance_region takes arrays",
    "ScoredPrediction": "scores take arrays",
    "ConsensusMember": "fuse_estimates takes arrays",
    "NoiseObservation": "fit_noise takes arrays",
    "Component": "Mixture has arrays of weights and densities",
    "FrameNames": "MixtureFile has the names",
    "RunOptions": "arguments of run",
    "ReportOptions": "arguments of write_report",
    "ReportMesh": "write_report takes a dict",
    "ReportCamera": "write_report takes a tuple",
    "ReportImages": "write_report takes a path",
    "Provenance": "results of the program have it",
    "ProvenanceInput": "results of the program have it",
    "ResultOptions": "what the program adds to results",
    "PoseSampleOptions": "arguments of read_pose_samples",
    "TumOptions": "arguments of read_tum",
    "NpyArray": "numpy reads it",
    "PlyMesh": "a file that reports read",
    "ConvertedDensity": "a step of to_projected and to_concentrated",
    "DatasetInstance": "a part of DatasetScene",
    "DatasetScene": "recordings of other packages are read by the program",
    "DatasetSequenceText": "recordings of other packages are read by the program",
    "PairedTest": "a step of fit_noise and of the studies",
    "AxisStatistics": "a step of the studies",
    "Autocorrelation": "a step of fit_noise",
    "PaperGridDivergence": "a step of the studies",
    "GaussianCubature": "a rule for integrals",
    "TangentGaussian": "recenter returns mean and covariance",
    "SplitPiece": "a step of the conversions",
    "Innovation": "a step of the filters",
    "ModeMeasurement": "a step of the filters",
    "ModeState": "a step of the filters",
    "ObservedObject": "a step of smoothing",
    "SmootherFrame": "a step of smoothing",
    "JointState": "a step of smoothing",
    "ViewingRay": "sight_error has its axes",
    "IntegerRange": "the range of a setting",
    "NumberRange": "the range of a setting",
    "MultiObjectNumber": "the range of a setting",
    "TwistMatrix": "a step of Exp and Log",
    "EstimateWithTruth": "consistency takes arrays",
    "StampedEstimate": "consistency takes arrays",
    "StampedTruth": "consistency takes arrays",
    "ConsistencySettings": "arguments of consistency",
    "MatchSettings": "arguments of consistency",
    "ObservedPart": "a step of consistency",
    "ObservedError": "a step of consistency",
    "StampedDensity": "numpy and posemix.interop read the columns",
    "CovarianceConvention": "posemix.interop has the conversions",
    "TraceTrack": "a file that posemix consistency reads",
    "NamedConsistency": "a part of pictures",
    "ConsistencyResults": "a part of files",
    "Chart": "a part of pictures",
    "ChartSeries": "a part of pictures",
    "FlagGroup": "a part of pictures",
    "FlagView": "a part of pictures",
    "ProjectedCovariance": "a step of the conversions",
    "ProjectedVariances": "a step of the conversions",
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


def namespaces(text: str, at: int) -> set[str]:
    """Names of the namespaces around a place of a text."""
    opened = re.finditer(r"^(?:inline )?namespace ([\w:]+) \{", text, re.MULTILINE)
    around = [m for m in opened if m.start() < at < closing(text, m.end() - 1)]
    return {name for m in around for name in m[1].split("::")}


def structs() -> dict[str, list[str]]:
    """Fields of the public structs by the struct's name, without those within classes and of tests."""
    found: dict[str, list[str]] = {}
    for path in sorted((ROOT / "include" / "posemix").rglob("*.hpp")):
        if path.parent.name == "testing":
            continue
        text = without_comments(path.read_text(encoding="utf-8"))
        for match in re.finditer(r"^struct (\w+)(?:<[^{;]*>)?(?: final)?\s*\{", text, re.MULTILINE):
            if namespaces(text, match.start()) & {"internal", "detail", "small_angle"}:
                continue
            body = text[match.end() : closing(text, match.end() - 1)]
            fields = [field_of(statement) for statement in statements(body)]
            found[match[1]] = [name for name in fields if name is not None]
    return found


STRUCTS = structs()
BOUND = sorted(STRUCTS.keys() - WITHOUT_CLASS.keys())


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
    assert bool(STRUCTS[name]) == (name not in EMPTY), f"no field of {name} was read from its header"
    for field in STRUCTS[name]:
        for attribute in renamed.get(field, (field,)):
            assert attribute in known, f"posemix.{public} lacks {name}::{field}"


@pytest.mark.parametrize("name", sorted(n for n in BOUND if n.endswith("Settings")))
def test_settings_have_only_fields_of_the_struct(name: str) -> None:
    made = getattr(px, name)()
    assert set(made.__getstate__()) <= set(STRUCTS[name])


def test_exceptions_are_of_structs_that_exist_and_are_not_bound() -> None:
    assert set(WITHOUT_CLASS) <= set(STRUCTS) and set(OTHER_NAMES) <= set(STRUCTS)
    assert not [name for name in WITHOUT_CLASS if hasattr(px, name)]
