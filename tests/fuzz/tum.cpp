// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include "invariants.hpp"
#include "posemix/io/tum.hpp"
#include "posemix/io/tum_covariance.hpp"
#include "posemix/slam/consistency.hpp"
#include "target.hpp"

/// TUM files of poses, and of poses with covariances: stamps rise, poses are poses, and what is
/// written is read again alike.
namespace posemix::fuzzing {
namespace {

void expect_same_poses(const SE3d& a, const SE3d& b) {
  const double scale = 1.0 + a.translation().norm();
  expect((a.translation() - b.translation()).norm() <= 1e-9 * scale, "another place after writing");
  expect((a.rotation().inverse() * b.rotation()).angle() < 1e-7, "another rotation after writing");
}

void read_poses(std::string_view text) {
  for (const bool zero_is_miss : {false, true}) {
    takes("f.txt", [&] {
      const TumOptions options{true, zero_is_miss};
      const auto frames = parse_tum(text, "f.txt", options);
      double last = -INFINITY;
      for (const StampedPose& frame : frames) {
        expect(std::isfinite(frame.stamp) && frame.stamp > last, "stamps that do not rise");
        last = frame.stamp;
        if (frame.pose) expect_pose(*frame.pose);
      }
      const auto again = parse_tum(format_tum(frames, TumMisses::write_zeros), "again", options);
      expect(again.size() == frames.size(), "another number of frames after writing");
      for (std::size_t k = 0; k < frames.size(); ++k) {
        expect(again[k].stamp == frames[k].stamp &&
                   again[k].pose.has_value() == frames[k].pose.has_value(),
               "another frame after writing");
        if (frames[k].pose) expect_same_poses(*frames[k].pose, *again[k].pose);
      }
    });
  }
}

void read_densities(std::string_view text, const CovarianceConvention& convention) {
  takes("f.txt", [&] {
    const auto frames = parse_tum_covariance(text, "f.txt", convention);
    std::vector<EstimateWithTruth> series;
    for (const StampedDensity& frame : frames) {
      expect_density(frame.density, "a line");
      series.push_back({frame.stamp, frame.density, SE3d(SO3d(), {1, 2, 3})});
    }
    // Nearly singular covariances are taken, but rounding may leave none that is definite.
    if (series.size() > 1) takes("consistency", [&] { consistency_of(series); });
    takes("again", [&] {
      const auto again = parse_tum_covariance(format_tum_covariance(frames), "again");
      expect(again.size() == frames.size(), "another number of frames after writing");
      for (std::size_t k = 0; k < frames.size(); ++k)
        expect_same_poses(frames[k].density.mean(), again[k].density.mean());
    });
  });
}

}  // namespace

POSEMIX_FUZZ_TARGET(tum) {
  const Choice choice(bytes);
  switch (choice.letter) {
    case 'r':
      return read_densities(choice.rest, CovarianceConvention::ros());
    case 'b':
      return read_densities(choice.rest, {ErrorSide::right, TangentOrder::rotation_translation});
    case 'l':
      return read_densities(choice.rest, {});
    default:
      return read_poses(choice.rest);
  }
}

}  // namespace posemix::fuzzing
