// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "detections.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "posemix/base/error.hpp"
#include "posemix/io/placeholder_covariance.hpp"

namespace posemix::internal {
namespace {

/// Of asymmetries up to rounding, relative to the largest number.
constexpr double kAsymmetry = 1e-6;

using RowMajor6d = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

/// The covariance along the object's axes, rotation first; none where the message gives none.
std::optional<Matrix6d> covariance_of(const SE3d& mean, const std::array<double, 36>& values) {
  Matrix6d matrix = Eigen::Map<const RowMajor6d>(values.data());
  if (is_placeholder_covariance(matrix)) return std::nullopt;
  require(matrix.allFinite(), "got a covariance that is not finite, expected finite numbers");
  const double asymmetry = (matrix - matrix.transpose()).cwiseAbs().maxCoeff();
  require(asymmetry <= kAsymmetry * matrix.cwiseAbs().maxCoeff(),
          "got a covariance that is not symmetric, expected a symmetric one");
  matrix = 0.5 * (matrix + matrix.transpose()).eval();
  const double least = Eigen::SelfAdjointEigenSolver<Matrix6d>(matrix, Eigen::EigenvaluesOnly)
                           .eigenvalues()
                           .minCoeff();
  if (!(least > 0.0)) {
    throw InvalidInput(
        fmt::format("got a covariance with the eigenvalue {:.3g}, expected a positive definite "
                    "one, or zeros, the identity or -1 as its first number where there is none",
                    least));
  }
  // Errors about and along the axes of the camera at the object: turned, they are along the
  // object's. Messages have the translation first.
  const Eigen::Matrix3d turn = mean.rotation().matrix().transpose();
  Matrix6d along;
  along.topLeftCorner<3, 3>() = turn * matrix.bottomRightCorner<3, 3>() * turn.transpose();
  along.bottomRightCorner<3, 3>() = turn * matrix.topLeftCorner<3, 3>() * turn.transpose();
  along.topRightCorner<3, 3>() = turn * matrix.bottomLeftCorner<3, 3>() * turn.transpose();
  along.bottomLeftCorner<3, 3>() = along.topRightCorner<3, 3>().transpose();
  return 0.5 * (along + along.transpose());
}

std::vector<ObservationComponent> components_of(const RosDetection& detection,
                                                const RosResult& best) {
  std::vector<std::size_t> numbers;
  std::vector<double> scores;
  for (std::size_t i = 0; i < detection.results.size(); ++i) {
    if (detection.results[i].class_id != best.class_id) continue;
    numbers.push_back(i);
    scores.push_back(detection.results[i].score);
  }
  const std::vector<double> weights =
      numbers.size() == 1 ? std::vector{1.0} : weights_of_scores(scores);
  std::vector<ObservationComponent> components;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    if (weights[k] == 0.0) continue;
    const RosResult& result = detection.results[numbers[k]];
    try {
      const SE3d mean = pose_of(result.pose);
      components.push_back({weights[k], mean, covariance_of(mean, result.covariance)});
    } catch (const InvalidInput& error) {
      throw InvalidInput(fmt::format("result {}: {}", numbers[k], error.what()));
    }
  }
  return components;
}

/// Where images of a message are, by their stamps.
LiveImage& image_at(std::int64_t stamp_ns, std::vector<LiveImage>& images) {
  const auto found = std::ranges::find(images, stamp_ns, &LiveImage::stamp_ns);
  if (found != images.end()) return *found;
  images.push_back({.stamp_ns = stamp_ns});
  return images.back();
}

/// Adds a detection with results, unless its score is too small.
void add_detection(const RosDetection& detection, const LiveSource& source,
                   const std::string& camera, LiveImage& image) {
  const RosResult& best = *std::ranges::max_element(detection.results, {}, &RosResult::score);
  std::vector<ObservationComponent> components;
  if (source.of_box) {
    components.push_back({.pose = pose_of(detection.box)});
  } else {
    components = components_of(detection, best);
  }
  if (!(best.score >= source.least_score)) return;
  std::string frame = source.frame.empty() ? frame_name(detection.header.frame) : source.frame;
  if (frame.empty()) frame = camera;
  image.detections.push_back({best.class_id, best.score, std::move(frame), std::move(components)});
}

}  // namespace

std::vector<double> weights_of_scores(const std::vector<double>& scores) {
  const bool are_shares =
      std::ranges::all_of(scores, [](double s) { return std::isfinite(s) && s >= 0.0; }) &&
      std::ranges::any_of(scores, [](double s) { return s > 0.0; });
  if (!are_shares) return std::vector(scores.size(), 1.0 / static_cast<double>(scores.size()));
  // Divided by the largest first, since the sum of large numbers may overflow.
  const double largest = *std::ranges::max_element(scores);
  std::vector<double> weights;
  weights.reserve(scores.size());
  for (const double score : scores) weights.push_back(score / largest);
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= sum;
  return weights;
}

std::vector<LiveImage> images_of(const RosDetections& message, const LiveSource& source,
                                 double arrival_s, std::int64_t now_ns) {
  const std::int64_t of_array = message.header.stamp_ns != 0 ? message.header.stamp_ns : now_ns;
  const std::string camera = source.frame.empty() ? frame_name(message.header.frame) : source.frame;
  std::vector<LiveImage> images;
  if (message.detections.empty()) image_at(of_array, images);
  for (std::size_t i = 0; i < message.detections.size(); ++i) {
    const RosDetection& detection = message.detections[i];
    // The header of the array may have the time of publication, and the detection's that of the
    // image.
    const std::int64_t own = detection.header.stamp_ns;
    LiveImage& image = image_at(own != 0 ? own : of_array, images);
    if (detection.results.empty()) continue;
    try {
      add_detection(detection, source, camera, image);
    } catch (const InvalidInput& error) {
      throw InvalidInput(fmt::format("{}: detection {} at {} ns: {}", source.name, i,
                                     image.stamp_ns, error.what()));
    }
  }
  for (LiveImage& image : images) {
    image.detector = source.detector;
    image.arrival_s = arrival_s;
    image.frame = camera;
    // The frame may stand in the headers of detections alone.
    if (camera.empty() && !image.detections.empty()) image.frame = image.detections.front().frame;
  }
  return images;
}

}  // namespace posemix::internal
