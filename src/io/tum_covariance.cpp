// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/tum_covariance.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "mixture_parts.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/rigid.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

constexpr std::size_t kPoseColumns = 8;
constexpr std::size_t kUpperColumns = kPoseColumns + 21;
constexpr std::size_t kFullColumns = kPoseColumns + 36;
constexpr double kSymmetry = 1e-6;  ///< of the largest entry, for rounded text

std::vector<double> parse_numbers(const LineReader& reader) {
  const std::vector<std::string_view> words = split_words(reader.line());
  if (words.size() != kUpperColumns && words.size() != kFullColumns) {
    reader.fail(fmt::format("{} columns", words.size()),
                words.size() == kPoseColumns
                    ? "29: a pose without its covariance says nothing on consistency"
                    : "29: stamp tx ty tz qx qy qz qw and the 21 numbers of the covariance's upper "
                      "triangle row by row, or 44 with all of its 36");
  }
  std::vector<double> numbers;
  numbers.reserve(words.size());
  for (std::size_t i = 0; i < words.size(); ++i)
    numbers.push_back(reader.number_from(words[i], fmt::format("column {}", i + 1)));
  return numbers;
}

Matrix6d parse_covariance(const std::vector<double>& numbers, const LineReader& reader) {
  Matrix6d covariance;
  if (numbers.size() == kFullColumns) {
    covariance = Eigen::Map<const Matrix6d>(numbers.data() + kPoseColumns);
  } else {
    std::size_t next = kPoseColumns;
    for (Eigen::Index i = 0; i < 6; ++i) {
      for (Eigen::Index j = i; j < 6; ++j) covariance(i, j) = covariance(j, i) = numbers[next++];
    }
  }
  const double largest = covariance.cwiseAbs().maxCoeff();
  if (largest == 0.0)
    reader.fail("a covariance of zeros (unknown)", "one that is positive definite");
  if ((covariance - covariance.transpose()).cwiseAbs().maxCoeff() > kSymmetry * largest)
    reader.fail("a covariance that is not symmetric", "a symmetric one");
  symmetrize(covariance);
  return covariance;
}

StampedDensity parse_frame(const LineReader& reader, const CovarianceConvention& convention) {
  const std::vector<double> numbers = parse_numbers(reader);
  PoseNumbers seven;
  std::copy_n(numbers.begin() + 1, seven.size(), seven.begin());
  const SE3d pose = pose_from_numbers(seven, reader);
  check_position(pose, fmt::format("{}:{}", reader.name(), reader.number()));

  const Matrix6d stated = parse_covariance(numbers, reader);
  if (Eigen::LLT<Matrix6d>(stated).info() != Eigen::Success)
    reader.fail("a covariance that is not positive definite", "one that is");
  Matrix6d covariance = left_covariance(pose, stated, convention);
  symmetrize(covariance);
  if (!covariance.allFinite()) reader.fail("a covariance beyond all numbers", "a smaller one");
  return {numbers[0], ConcentratedGaussian<SE3d>::trusted(pose, covariance)};
}

}  // namespace

Matrix6d left_covariance(const SE3d& pose, const Matrix6d& covariance,
                         const CovarianceConvention& convention) {
  Matrix6d ordered = internal::plain_covariance(covariance, {.order = convention.order});
  switch (convention.side) {
    case ErrorSide::left:
      break;
    case ErrorSide::right:
      return pose.adjoint_congruence(ordered);
    case ErrorSide::fixed:
      return SE3d(SO3d(), pose.translation()).adjoint_congruence(ordered);
  }
  return ordered;
}

std::vector<StampedDensity> parse_tum_covariance(std::string_view text, const std::string& name,
                                                 const CovarianceConvention& convention) {
  std::vector<StampedDensity> frames;
  LineReader reader(text, name);
  while (reader.next_content()) {
    StampedDensity frame = parse_frame(reader, convention);
    if (!frames.empty() && !(frame.stamp > frames.back().stamp)) {
      reader.fail(fmt::format("stamp {} after stamp {}", frame.stamp, frames.back().stamp),
                  "strictly increasing stamps");
    }
    frames.push_back(std::move(frame));
  }
  if (frames.empty()) {
    throw InvalidInput(fmt::format(
        "{}: got no poses, expected lines 'stamp tx ty tz qx qy qz qw' with a covariance", name));
  }
  return frames;
}

std::vector<StampedDensity> read_tum_covariance(const std::filesystem::path& path,
                                                const CovarianceConvention& convention) {
  return parse_tum_covariance(read_file(path), path.string(), convention);
}

std::string format_tum_covariance(std::span<const StampedDensity> frames) {
  std::string text;
  for (const StampedDensity& frame : frames) {
    text += fmt::format("{} {}", frame.stamp, format_pose(frame.density.mean()));
    const Matrix6d& covariance = frame.density.covariance();
    for (Eigen::Index i = 0; i < 6; ++i) {
      for (Eigen::Index j = i; j < 6; ++j) text += fmt::format(" {:.12g}", covariance(i, j) + 0.0);
    }
    text += '\n';
  }
  return text;
}

}  // namespace posemix
