// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "posemix/detector/noise_correlation.hpp"
#include "study.hpp"

/// The parts of `study noise`.
namespace posemix {

/// The recordings that are studied together.
struct NoiseGroup {
  std::string detector;
  std::string object;
  bool one_class = true;  ///< all sets are of one class of objects
  std::vector<ResidualSet> sets = {};
};

inline constexpr std::array<const char*, 6> kNoiseAxes{
    "rotation_x", "rotation_y", "rotation_z", "translation_x", "translation_y", "translation_z"};

/// One group by detector and object, in the order of appearance, and `all` of a detector, without
/// symmetric objects, after its objects where it has several.
std::vector<NoiseGroup> noise_groups(const std::vector<ResidualSet>& sets);

/// The frames with a truth of every set. Sets of the same name of recording have the same number.
std::vector<NoiseTrack> tracks_of(const NoiseGroup& group);
std::vector<NoiseObservation> observations_of(std::span<const NoiseTrack> tracks);

/// The result of one work item: statistics, histograms and models.
nlohmann::ordered_json study_noise(const NoiseGroup& group, const NoiseStudySettings& settings,
                                   std::size_t item);

/// What a fit of so many components is to do.
NoiseFitSettings noise_fit_settings(const NoiseStudySettings& settings, std::size_t components);

/// Fits of 1, 2, ... components.
std::vector<NoiseFit> fit_noise_sizes(std::span<const NoiseObservation> observations,
                                      const NoiseStudySettings& settings, RandomStream& stream);

/// How well a kind of model predicts detections that it was not fitted to.
struct NoiseValidation {
  NoiseFrame frame;
  bool clutter;
  std::size_t components;
  double log_density;                ///< mean per detection [nats]
  std::vector<double> by_fold = {};  ///< the same by fold
  double below_best = 0.0;           ///< what the best of all kinds has more
  double standard_error = 0.0;       ///< of that, from the folds' differences
};

/// Models of 1 to max_components components, with and without clutter, in all frames. Folds are of
/// whole recordings, or where there are fewer of those, of blocks of time.
std::vector<NoiseValidation> cross_validate(const std::vector<NoiseTrack>& tracks,
                                            const NoiseStudySettings& settings, std::size_t item);
nlohmann::ordered_json validation_json(const std::vector<NoiseValidation>& rows);

/// Letters, digits, '_' and '-' of detector and object: the name of files and of the noise model.
std::string noise_name(const std::string& detector, const std::string& object);

/// The odometry's work item, and the files that it makes.
nlohmann::ordered_json study_odometry(const std::vector<OdometryRecording>& recordings,
                                      const NoiseStudySettings& settings);
void report_odometry(const nlohmann::ordered_json& item, StudyReport& report);

StudyReport report_noise(std::span<const std::string> results);

/// The number, or null where it is not finite.
nlohmann::ordered_json finite_json(double value);
nlohmann::ordered_json modes_json(const std::vector<NoiseMode>& modes);
nlohmann::ordered_json correlation_json(const NoiseCorrelation& correlation);
/// What a noise model's text needs of it.
NoiseCorrelation correlation_from_json(const nlohmann::ordered_json& json);
nlohmann::ordered_json noise_to_json(const DetectorNoise& noise);
DetectorNoise noise_from_json(const nlohmann::ordered_json& json);

}  // namespace posemix
