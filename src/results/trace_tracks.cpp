// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/results/trace_tracks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "io/json_fault.hpp"
#include "io/json_place.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

using namespace internal;

/// Large parts of a trace that are not needed here.
constexpr std::array<std::string_view, 16> kLeftOut{"hypotheses",
                                                    "alternatives",
                                                    "detection",
                                                    "status",
                                                    "sd",
                                                    "merges",
                                                    "position_covariance",
                                                    "existence",
                                                    "health",
                                                    "models",
                                                    "register_again",
                                                    "twist",
                                                    "twist_sd",
                                                    "mode_probability",
                                                    "nees",
                                                    "nis"};

Json read_needed(const std::filesystem::path& path) {
  constexpr int kIds = 2;  // the depth of objects' ids, which may be any word
  const auto keep = [&](int depth, Json::parse_event_t event, Json& parsed) {
    check_json_depth(depth, path.string());
    if (event != Json::parse_event_t::key || depth == kIds) return true;
    const auto& key = parsed.get_ref<const std::string&>();
    return std::find(kLeftOut.begin(), kLeftOut.end(), key) == kLeftOut.end();
  };
  try {
    return Json::parse(read_file(path), keep);
  } catch (const Json::exception& error) {
    refuse_json(error, path.string(), "JSON as posemix writes it");
  }
}

SE3d pose_of(const JsonPlace& place) {
  const Eigen::VectorXd numbers = place.vector(7);
  const Eigen::Quaterniond quaternion(numbers[6], numbers[3], numbers[4], numbers[5]);
  if (!(std::abs(quaternion.norm() - 1.0) <= kJsonNormTolerance))
    place.fail(fmt::format("a quaternion of norm {:.6g}", quaternion.norm()), "norm 1");
  return SE3d(SO3d::from_quaternion(quaternion), numbers.head<3>());
}

Matrix6d covariance_of(const JsonPlace& place) {
  const Eigen::VectorXd upper = place.vector(21);
  Matrix6d covariance;
  Eigen::Index next = 0;
  for (Eigen::Index i = 0; i < 6; ++i) {
    for (Eigen::Index j = i; j < 6; ++j) covariance(i, j) = covariance(j, i) = upper[next++];
  }
  if (Eigen::LLT<Matrix6d>(covariance).info() != Eigen::Success)
    place.fail("a covariance that is not positive definite", "one that is");
  return covariance;
}

SymmetryGroup symmetries_of(const JsonPlace& place) {
  std::vector<SE3d> elements;
  for (const JsonPlace& element : place.member("elements").items())
    elements.push_back(pose_of(element));
  std::vector<SymmetryAxis> axes;
  for (const JsonPlace& axis : place.member("axes").items())
    axes.push_back({axis.member("direction").vector(3), axis.member("point_m").vector(3)});
  return SymmetryGroup(elements, axes);
}

/// A track's arrays over the frames of the trace.
class TrackReader {
 public:
  TrackReader(const Json& json, std::string path, const std::vector<double>& stamps)
      : json_(json), place_(json, std::move(path)), stamps_(stamps) {}

  TraceTrack track(std::string name) const {
    if (!place_.has("covariance")) {
      place_.fail("no covariances, as older versions wrote it",
                  "one with covariances: run posemix slam again");
    }
    TraceTrack track{std::move(name), {}, {}};
    const std::vector<JsonPlace> covariances = place_.member("covariance").items(stamps_.size());
    each("pose", [&](std::size_t k, const JsonPlace& pose) {
      track.estimates.push_back(
          {stamps_[k], PoseDensity::trusted(pose_of(pose), covariance_of(covariances[k]))});
    });
    if (!json_.at("truth").is_null()) {
      each("truth", [&](std::size_t k, const JsonPlace& pose) {
        track.truth.push_back({stamps_[k], pose_of(pose)});
      });
    }
    return track;
  }

 private:
  template <class Take>
  void each(const char* key, const Take& take) const {
    const std::vector<JsonPlace> items = place_.member(key).items(stamps_.size());
    for (std::size_t k = 0; k < items.size(); ++k) {
      if (!json_.at(key)[k].is_null()) take(k, items[k]);
    }
  }

  const Json& json_;
  JsonPlace place_;
  const std::vector<double>& stamps_;
};

}  // namespace

std::vector<TraceTrack> read_trace_tracks(const std::filesystem::path& path) {
  const Json json = read_needed(path);
  const JsonPlace root(json, path.string());
  root.member("type").require_word("posemix.trace");
  std::vector<double> stamps;
  for (const JsonPlace& stamp : root.member("stamps_s").items()) stamps.push_back(stamp.number());
  const auto read = [&](const JsonPlace& place, const Json& of, const std::string& name) {
    for (const char* key : {"pose", "truth"}) place.member(key);
    return TrackReader(of, path.string() + ": " + name, stamps).track(name);
  };
  std::vector<TraceTrack> tracks{read(root.member("camera"), json.at("camera"), "camera")};
  const JsonPlace objects = root.member("objects");
  for (const std::string& id : objects.keys()) {
    const JsonPlace object = objects.member(id);
    const Json& of = json.at("objects").at(id);
    const SymmetryGroup symmetries =
        object.has("symmetries") ? symmetries_of(object.member("symmetries")) : SymmetryGroup();
    for (const char* kind : {"world", "relative"}) {
      const std::string name = fmt::format("objects/{}/{}", id, kind);
      tracks.push_back(read(object.member(kind), of.at(kind), name));
      tracks.back().symmetries = symmetries;
    }
  }
  return tracks;
}

}  // namespace posemix
