// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "posemix/base/linear.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/config/toml_table.hpp"
#include "posemix/detector/noise_fit.hpp"
#include "posemix/detector/odometry_noise.hpp"
#include "study/engine/study.hpp"

/// The errors of a detector (midway-merge paper, Fig. 5): statistics of its residuals against
/// ground truth, and a noise model fitted to them.
namespace posemix {

/// The detections of one object in one recording, with the truth; one entry per frame.
struct ResidualSet {
  std::string detector;
  std::string object;  ///< the object's class
  std::string recording;
  /// The truth is the mean of the detections themselves, which hides their common error.
  bool proxy = false;
  /// The object looks the same in several poses, of which the detector reports any, so that the
  /// residuals are not those of the detector.
  bool symmetric = false;
  std::vector<std::optional<SE3d>> truth = {};     ///< T_camera_object
  std::vector<std::optional<SE3d>> detected = {};  ///< T_camera_object
  std::vector<double> stamps_s = {};               ///< of the frames; none where they are not known
};

/// The data of `study noise`.
struct NoiseData {
  std::vector<ResidualSet> residuals = {};
  std::vector<OdometryRecording> odometry = {};  ///< every sequence that has it with a truth, once
};

/// Settings of `study noise`.
struct NoiseStudySettings {
  /// The fit of every group; the frame is the object's unless it is given.
  NoiseFitSettings fit = {.frame = NoiseFrame::object, .clutter = false, .modes = false};
  std::uint64_t seed = 1;
  double gross_rotation_deg = 20.0;  ///< beyond one of these a detection is a gross error
  double gross_translation_m = 0.1;  ///< in metres for every frame
  std::size_t bins = 60;
  OdometryNoiseSettings odometry = {};
  std::vector<std::string> detectors = {};  ///< only these; all where empty
  std::vector<std::string> sequences = {};  ///< paths of sequence files
  std::string detections = {};              ///< or of two TUM files of T_camera_object
  std::string ground_truth = {};
};

/// Reads settings: `max_components`, `restarts`, `seed`, `frame` ("object", "camera", "ray"),
/// `means` ("zero", "free"), `covariance` ("diagonal", "full"), `clutter` (default: in frame ray),
/// `clutter_volume_m3`, `clutter_least`, `modes`, `mode_radius_deg`, `mode_share`,
/// `mode_recordings`, `bic` ("frames", "effective"), `folds`, `max_rotation_sd_deg`,
/// `max_translation_sd_m`, `gross_rotation_deg`, `gross_translation_m`, `bins`, `windows_s`,
/// `bootstrap`, `detectors`, and what is to be read in place of a data folder: `sequences` (paths
/// of sequence files) or `detections` and `ground_truth` (TUM files of T_camera_object).
/// @throws InvalidInput naming file, line and key
NoiseStudySettings read_noise_settings(const TomlTable& table);

/// Has the settings that had another name in the release before read by it, with a warning.
/// @throws InvalidInput where the document has both
void rename_noise_keys(TomlDocument& document);

/// The detections of a sequence that have a truth, one set per object that has any.
std::vector<ResidualSet> residuals_of(const SlamJob& job, const std::string& detector,
                                      const std::string& recording);

/// Every recording of a data folder (find_recordings). CosyPose's recordings have no ground truth
/// of the objects; there it is a proxy.
NoiseData find_noise_data(const std::filesystem::path& data);

/// What the settings name: sequence files (paths in them as data_folders says), two TUM files
/// (stamps within 1 ms belong together), or else the data folder, default_data_folder() where none
/// is given.
/// @throws InvalidInput naming the file that is missing or not valid
NoiseData read_noise_data(const NoiseStudySettings& settings,
                          const std::optional<std::filesystem::path>& data);

/// The study: one item per detector and class of objects (its recordings together), one per
/// detector with several classes for all of them but symmetric ones (object `all`), and one for the
/// odometry. Report: study.json and noise.csv (one row per object and axis: `detector`, `object`,
/// `axis`, `count`, `mean`, `sd`, `kurtosis`, `lag1_autocorrelation`, `correlation_frames`, ...;
/// rotations in degrees, translations in metres or of the range), models.csv (log-likelihood and
/// BIC by number of components), modes.csv, correlation.csv and validation.csv, slow_error.csv
/// (white, slow and common deviations with standard errors), dependence.csv (correlation lengths,
/// run length, mode time) and slow_models.txt (likelihoods of all forms of slow errors), and per
/// object noise_NAME.toml with the chosen model and noise_NAME.svg with histograms; odometry.toml,
/// odometry.csv and odometry.svg.
/// @throws InvalidInput for means that are free in another frame than the object's or beside a
/// clutter, modes without clutter, and when an object has too few detections with a truth
Study make_noise_study(const NoiseData& data, const NoiseStudySettings& settings);

}  // namespace posemix
