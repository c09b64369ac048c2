# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Where files set the fields of settings: the function that reads a key, and the section that documents it."""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Place:
    """Where keys are read and documented.

    `reader` is a source file in src/config and its functions that read them, `section` the heading in the document.
    Keys are in the first column of a table of the section; with a `row`, anywhere in the row of that key; with
    `prose`, outside tables.
    """

    reader: str
    section: str
    page: str = "formats.md"
    row: str = ""
    prose: bool = False

    def by(self, reader: str) -> Place:
        return replace(self, reader=reader)

    def in_row(self, row: str) -> Place:
        return replace(self, row=row)


Keys = dict[str, "str | tuple[str | tuple[str, ...], Place]"]

FILTER = "`[filter]`"
RANGES = Place("../../include/posemix/filter/multi_object_ranges.hpp", FILTER)
MULTI = Place("sequence_multi_object.cpp read_multi_object", FILTER)
ASSOCIATION = Place("sequence_multi_object.cpp read_association", "Classes")
OBJECT_MOTION = Place("sequence_motion.cpp read_object_motion", "Objects that move")
MOVING = Place("sequence_multi_object.cpp read_moving_objects", FILTER, row="moving")
COME_AND_GO = "Objects that come and go"
EXISTENCE = Place("sequence_multi_object.cpp read_existence", COME_AND_GO)
HEALTH = Place("sequence_multi_object.cpp read_health", COME_AND_GO)
OBSERVED = "Observations of a recording"
SMOOTHING = Place("sequence_filter.cpp read_smoothing", FILTER)
SUM = Place("sequence_filter.cpp read_gaussian_sum", FILTER)
REDUCTION = Place("sequence_filter.cpp read_reduction", FILTER)
PARTICLES = Place("sequence_filter.cpp read_particles", FILTER)
MOTION = Place("sequence_camera.cpp read_motion", "`[motion]`")
PROCESS = Place("sequence_camera.cpp read_process_noise", "`[motion]`", prose=True)
MODEL = Place("sequence_models.cpp read_model", "`[[objects]]`")
NOISE = Place("sequence_noise.cpp read_component", "`[noise.NAME]`")
CLUTTER = Place("sequence_noise.cpp read_clutter", "`[noise.NAME]`", row="clutter")
DEPENDENCE = Place("sequence_noise.cpp read_dependence", "`[noise.NAME]`")
SLOW = Place("sequence_noise.cpp read_slow", "`[noise.NAME]`", row="slow")
SIMULATED = Place("simulation_config.cpp get_object", "The configuration", "simulation.md")
COMPONENT = SIMULATED.by("simulation_config.cpp get_component").in_row("noise.<name>.components")
SD = SIMULATED.by("simulation_scene.cpp get_sd")
RUNS = SIMULATED.by("simulation_scene.cpp get_runs")
SCENE = SIMULATED.by("simulation_scene.cpp get_motions")
MOVES = SIMULATED.by("simulation_scene.cpp get_moves").in_row("pick_and_place")
SPAN = "simulation_scene.cpp get_span"
PATH = SIMULATED.by("simulation_config.cpp get_path")
WHOLE = SIMULATED.by("simulation_config.cpp read_simulation")

# Structs that a file sets: where, and fields whose key has another name or another place.
IN_FILES: dict[str, tuple[Place, Keys]] = {
    "MultiObjectSettings": (
        RANGES,
        {
            "merge_rotation_rad": ("merge_rotation_deg", MULTI),
            "max_hypotheses": ("max_hypotheses", MULTI),
            "protected_hypotheses": ("protected_hypotheses", MULTI),
            "max_global_hypotheses": ("max_global_hypotheses", MULTI),
        },
    ),
    "MultiObjectSlamSettings": (
        ASSOCIATION,
        {
            "cameras": ("cameras", Place("sequence_observations.cpp read_body_cameras", OBSERVED)),
            "on_sight": ("on_sight", Place("sequence_file.cpp read_observed", OBSERVED)),
            "moving": ("moving", Place("sequence_multi_object.cpp read_moving_objects", FILTER)),
            "frames": ("frames", OBJECT_MOTION.by("sequence_motion.cpp read_known_frames")),
            "existence": ("existence", Place("sequence_multi_object.cpp read_existence", FILTER)),
            "health": ("health", Place("sequence_multi_object.cpp read_health", FILTER)),
        },
    ),
    "BodyCamera": (
        Place("sequence_observations.cpp read_body_cameras", OBSERVED),
        {
            "body_camera": "pose",
            "covariance": (
                ("rotation_sd_deg", "translation_sd_m", "covariance"),
                Place("sequence_observations.cpp read_camera_covariance", OBSERVED),
            ),
        },
    ),
    "AssociationSettings": (ASSOCIATION, {}),
    "StampedSlamSettings": (Place("../live/settings.cpp read_stamped_settings", "`[stamped]`", "live.md"), {}),
    "MovingObjectSettings": (MOVING, {"merge_rotation_rad": "merge_rotation_deg"}),
    "ExistenceSettings": (EXISTENCE, {}),
    "HealthSettings": (HEALTH, {}),
    "SmoothingSettings": (
        SMOOTHING,
        {"lag_frames": "smooth_lag", "passes": "smooth_passes", "least_probability": "smooth_least_probability"},
    ),
    "GaussianSumSettings": (SUM, {}),
    "ReductionSettings": (REDUCTION, {"pair": "pair_rule"}),
    "MergeSettings": (REDUCTION, {"rule": "merge_rule", "jacobian": "transport_jacobian"}),
    "ParticleFilterSettings": (
        PARTICLES,
        {
            "seed": "particle_seed",
            "object_walk": (("particle_walk_rotation_sd_deg", "particle_walk_translation_sd_m"), PARTICLES),
            "kernel": (("particle_kernel_rotation_sd_deg", "particle_kernel_translation_sd_m"), PARTICLES),
            "hypotheses": "particle_hypotheses",
        },
    ),
    "MotionSettings": (MOTION, {"walk": "noise"}),
    "ProcessNoise": (PROCESS, {"covariance": (("rotation_sd_deg", "translation_sd_m"), PROCESS)}),
    "ObjectModel": (
        MODEL,
        {
            "id": ("id", MODEL.by("sequence_models.cpp read_id")),
            "noise": ("noise", MODEL.by("sequence_models.cpp add_used_noise")),
            "detectors": ("detectors", MODEL.by("sequence_models.cpp read_detectors")),
            "independent_start": "start",
            "class_id": "class",
            "motion": ("motion", replace(OBJECT_MOTION, prose=True)),
            "symmetries": ("symmetries", MODEL.by("symmetries.cpp read_object_symmetries")),
        },
    ),
    "NoiseComponent": (
        NOISE,
        {
            "covariance": (
                ("rotation_sd_deg", "translation_sd_m", "translation_sd_of_range", "covariance"),
                NOISE.by("sequence_noise.cpp read_covariance"),
            ),
            "offset": (
                ("offset", "rotation_deg", "translation_m"),
                NOISE.by("sequence_noise.cpp read_offset").in_row("offset"),
            ),
        },
    ),
    "NoiseDependence": (DEPENDENCE, {"slow": ("slow", SLOW.in_row(""))}),
    "SlowError": (
        SLOW,
        {
            "covariance": (
                ("rotation_sd_deg", "translation_sd_m", "translation_sd_of_range", "covariance"),
                SLOW.by("sequence_noise.cpp read_covariance"),
            ),
            "correlation_angle_rad": "correlation_angle_deg",
        },
    ),
    "Clutter": (CLUTTER, {}),
    "SimulationSwing": (SIMULATED.by("simulation_config.cpp get_swing").in_row("camera.range"), {}),
    "SimulationPath": (PATH, {"view": ("view", SIMULATED.by("simulation_scene.cpp get_view"))}),
    "SimulationView": (SIMULATED.by("simulation_scene.cpp get_view").in_row("camera.view"), {}),
    "SimulationPlace": (
        SIMULATED.by("simulation_scene.cpp get_place").in_row("places"), {"rotation_rad": "rotation_deg"},
    ),
    "SimulationConveyor": (
        SIMULATED.by("simulation_scene.cpp get_conveyor").in_row("conveyor"),
        {
            "start_s": ("start_s", SIMULATED.by(SPAN).in_row("conveyor")),
            "stop_s": ("stop_s", SIMULATED.by(SPAN).in_row("conveyor")),
            "turn_rad_s": "turn_deg_s",
        },
    ),
    "SimulationHandHeld": (
        SIMULATED.by("simulation_scene.cpp get_hand_held").in_row("hand_held"),
        {
            "start_s": ("start_s", SIMULATED.by(SPAN).in_row("hand_held")),
            "stop_s": ("stop_s", SIMULATED.by(SPAN).in_row("hand_held")),
            "reach_rad": "reach_deg",
            "acceleration": (
                ("acceleration_rotation_sd_deg", "acceleration_translation_sd_m"),
                SIMULATED.by("simulation_scene.cpp get_hand_held").in_row("hand_held"),
            ),
        },
    ),
    "SimulationMoves": (
        MOVES,
        {
            "start_s": ("start_s", MOVES.by(SPAN)),
            "stop_s": ("stop_s", MOVES.by(SPAN)),
            "places": ("places", MOVES.by("simulation_scene.cpp get_places")),
        },
    ),
    "SimulationPickAndPlace": (SIMULATED.by("simulation_scene.cpp get_pick_and_place").in_row("pick_and_place"), {}),
    "SimulationPutDown": (SIMULATED.by("simulation_scene.cpp get_put_down").in_row("put_down"), {}),
    "SimulationHeld": (
        SIMULATED.by("simulation_scene.cpp get_held").in_row("held"),
        {
            "start_s": ("start_s", SIMULATED.by(SPAN).in_row("held")),
            "stop_s": ("stop_s", SIMULATED.by(SPAN).in_row("held")),
        },
    ),
    "SimulationWaypoint": (
        SIMULATED.by("simulation_scene.cpp get_waypoint").in_row("frames"),
        {"place": (("position_m", "rotation_deg"), SIMULATED.by("simulation_scene.cpp get_place").in_row("frames"))},
    ),
    "SimulationFrame": (
        SIMULATED.by("simulation_scene.cpp get_frame").in_row("frames"),
        {"error": (("rotation_sd_deg", "translation_sd_m"), SD.in_row("frames"))},
    ),
    "SimulationClutter": (
        SIMULATED.by("simulation_scene.cpp get_clutter_source"),
        {
            "class_id": "class",
            "places": ("places", SIMULATED.by("simulation_scene.cpp get_places")),
            "runs": (("fraction", "mean_run_s"), RUNS),
            "sd": (("rotation_sd_deg", "translation_sd_m"), SD),
        },
    ),
    "SimulationSd": (SD.in_row("odometry"), {"rotation_rad": "rotation_sd_deg", "translation_m": "translation_sd_m"}),
    "SimulationNoise": (
        COMPONENT,
        {
            "sd": (
                ("rotation_sd_deg", "translation_sd_m", "translation_sd_of_range"),
                SD.in_row("noise.<name>.components"),
            ),
            "offset_rotation_rad": (("offset", "rotation_deg"), COMPONENT),
            "offset_translation_m": (("offset", "translation_m"), COMPONENT),
        },
    ),
    "SimulationSlowError": (
        SIMULATED.by("simulation_config.cpp get_slow").in_row("slow"),
        {
            "sd": (
                ("rotation_sd_deg", "translation_sd_m", "translation_sd_of_range"),
                SD.in_row("slow"),
            ),
            "correlation_s": "correlation_time_s",
            "correlation_angle_rad": "correlation_angle_deg",
        },
    ),
    "SimulationRuns": (RUNS.in_row("misses"), {}),
    "SimulationFlips": (
        SIMULATED.in_row("flips"),
        {"runs": (("fraction", "mean_run_s"), RUNS.in_row("flips")), "rotation_rad": "rotation_deg"},
    ),
    "SimulationOutliers": (
        SIMULATED.in_row("outliers"), {"runs": (("fraction", "mean_run_s"), RUNS.in_row("outliers"))},
    ),
    "SimulationObject": (
        SIMULATED,
        {
            "class_id": "class",
            "rotation_rad": "rotation_deg",
            **{
                key: (key, SCENE)
                for key in ("appears_s", "removed_s", "conveyor", "hand_held", "pick_and_place", "put_down", "held")
            },
            "claimed": "claimed_noise",
            "slow": ("slow", SIMULATED.by("simulation_config.cpp get_slow")),
        },
    ),
    "SimulationConfig": (
        WHOLE,
        {
            "path": "camera",
            "claimed_odometry": "motion",
            "objects": ("objects", SIMULATED.by("simulation_config.cpp get_objects")),
            "frames": ("frames", SIMULATED.by("simulation_scene.cpp get_frames")),
            "clutter": ("clutter", SIMULATED.by("simulation_scene.cpp get_clutter")),
        },
    ),
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
    "SimulationPickAndPlace.moves": "its fields are keys of the same table",
    "SimulationPutDown.moves": "its fields are keys of the same table",
}

# Settings that no sequence or simulation file sets, and who does.
WITHOUT_FILE = {
    "ObjectSlamSettings": "its parts have tables of their own",
    "EmSettings": "options of posemix fit", "FuseSettings": "limits of the arithmetic",
    "ProjectedFuseSettings": "options of posemix fuse", "ProjectedMixtureFuseSettings": "options of posemix fuse",
    "ProjectedMixtureComposeSettings": "options of posemix compose", "ConversionSettings": "options of posemix convert",
    "DivergenceSamplingSettings": "options of posemix divergence", "SuccessSettings": "options of posemix grasp",
    "ConsistencySettings": "options of posemix consistency", "MatchSettings": "options of posemix consistency",
    "BestGraspSettings": "options of posemix grasp", "NoiseFitSettings": "settings of posemix study noise",
    "NoiseModeSettings": "settings of posemix study noise", "NoiseEmSettings": "a step of fit_noise",
    "OdometryNoiseSettings": "settings of posemix study noise", "ErrorMixtureSettings": "a part of the grasp study",
    "LogisticSettings": "a part of the grasp study", "ConsensusSettings": "a part of the grasp study",
    "FiducialSettings": "options of posemix fiducials", "FiducialSequenceSettings": "options of posemix fiducials",
    "FuseViewsSettings": "options of posemix fuse-views", "BopObservationSettings": "options of posemix fuse-views",
    "RelocaliseSettings": "options of posemix relocalise",
    "RegionFitSettings": "a part of the grasp study", "MeanSettings": "limits of the arithmetic",
    "MomentSettings": "limits of the arithmetic", "IteratedUpdateSettings": "limits of the arithmetic",
    "CauchySettings": "GaussianSumSettings.cauchy_scale sets it",
    "RotationQuadratureSettings": "limits of the arithmetic",
}  # fmt: skip
