// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "study.hpp"
#include "study/engine/study.hpp"
#include "study/engine/table.hpp"
#include "study/recordings/recordings.hpp"

/// The parts of `study ycbv`.
namespace posemix {

/// Columns of study.json. The first four are texts, the last says where an object's truth is from.
const std::vector<std::string>& ycbv_columns();
/// Columns of timing.csv; the first four are texts.
const std::vector<std::string>& ycbv_timing_columns();
inline constexpr std::size_t kYcbvTexts = 4;
/// Bins of the probability of a mode, of equal width.
inline constexpr std::size_t kForecastBins = 10;

enum class YcbvKind { detector, odometry, filter, published_offline };

/// A method as it is applied.
struct YcbvMethod {
  std::string name;
  YcbvKind kind = YcbvKind::filter;
  bool published = false;              ///< by the profile of that name
  bool paper_noise = false;            ///< DOPE: the noise model `gaussian`
  std::vector<std::string> overrides;  ///< of the profile

  bool fits(const Recording& recording) const;
};

/// @throws InvalidInput for a name that is not known
YcbvMethod find_ycbv_method(const std::string& name);

/// The recording as the method takes it.
SlamJob read_ycbv_job(const YcbvStudySettings& settings, const Recording& recording,
                      const YcbvMethod& method);

/// The rows of one item, those of study.json and those of timing.csv.
struct YcbvRows {
  std::vector<std::vector<Cell>> results;
  std::vector<std::vector<Cell>> timing;
  std::vector<std::vector<Cell>> forecasts = {};  ///< of the mode, by bins of its probability
};

/// Runs one method on one recording.
YcbvRows run_ycbv(const YcbvStudySettings& settings, const Recording& recording,
                  const YcbvMethod& method);

/// As one line of JSON, and back.
std::string format_ycbv_rows(const YcbvRows& rows);
YcbvRows parse_ycbv_rows(const std::string& text);

/// A published result of an offline method on one recording.
struct PublishedPixels {
  std::string method;  ///< "published: ACT"
  double pixels;       ///< the median of the pixel metric [px]
};

/// The published results for a recording, from derived/slam6d_published_table1.csv of the data
/// folder; none where there is no such file or it lacks the recording, or for another detector.
/// @throws InvalidInput for a file that is not valid
std::vector<PublishedPixels> published_pixels(const Recording& recording);

/// Whether a row of that method is a PublishedPixels.
bool is_published_offline(std::string_view method);

/// One row by detector and method of what the rows of all recordings come to, see
/// ycbv_summary.cpp.
StudyTable summarise_ycbv(const StudyTable& rows);

StudyReport report_ycbv(std::span<const std::string> items);

/// reliability.csv and reliability.svg: by detector and method, how often the mode was right
/// against its probability, every recording and object with the same weight.
std::vector<StudyFile> report_forecasts(std::span<const std::vector<Cell>> forecasts);

/// errors.svg: the errors of every method, sorted; camera.svg: the camera's error against that of
/// the odometry alone.
std::vector<StudyFile> draw_ycbv(const StudyTable& rows);

/// The metric of the published table of slam-super-6d: the median over frames and nine points (the
/// corners and the centre of the object's cuboid) of the distance in the image between estimate and
/// truth [px], infinite for a point behind the camera.
class PixelMetric {
 public:
  /// Nothing where the data folder lacks intrinsics (experiments/ycbv/odom/YCB.yaml, from sequence
  /// 0060 on YCB2.yaml) or the object's cuboid (experiments/ycbv/_ycb_original.json).
  /// @throws InvalidInput for a file that is not valid
  static std::optional<PixelMetric> find(const Recording& recording);

  /// The median over pairs of estimated and true T_camera_object; nothing for no pair.
  std::optional<double> median(std::span<const std::pair<SE3d, SE3d>> poses) const;

 private:
  double distance(const SE3d& estimate, const SE3d& truth, const Eigen::Vector3d& point) const;

  Eigen::Vector2d focal_;
  std::vector<Eigen::Vector3d> points_;
};

}  // namespace posemix
