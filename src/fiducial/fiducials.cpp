// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/fiducial/fiducials.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "io/covariance_columns.hpp"
#include "plausibility.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

using MinimaOfSightings = std::vector<std::vector<TagMinimum>>;

/// Cameras by topic and by name.
std::map<std::string, std::size_t> index_by_topic(std::span<const RigCamera> cameras) {
  std::map<std::string, std::size_t> index;
  const auto add = [&](const std::string& topic, std::size_t camera) {
    const auto [known, fresh] = index.emplace(topic, camera);
    if (!fresh && known->second != camera) {
      throw InvalidInput(fmt::format("the topic {} is that of cameras {} and {}, expected one",
                                     in_quotes(topic), cameras[known->second].name,
                                     cameras[camera].name));
    }
  };
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    add(cameras[i].name, i);
    for (const std::string& topic : cameras[i].topics) add(topic, i);
  }
  return index;
}

/// Goes through the sightings once.
class Observer {
 public:
  Observer(std::span<const CornerSighting> sightings, std::span<const RigCamera> cameras,
           const TagMap& tags, const FiducialSettings& settings)
      : sightings_(sightings), cameras_(cameras), tags_(tags), settings_(settings) {
    out_.sightings = sightings.size();
    minima_.resize(cameras.size());
  }

  Fiducials run() {
    const std::map<std::string, std::size_t> cameras = index_by_topic(cameras_);
    for (std::size_t i = 0; i < sightings_.size(); ++i) {
      const auto camera = cameras.find(sightings_[i].topic);
      if (camera == cameras.end()) {
        throw InvalidInput(
            fmt::format("{}: got the topic {}, expected that of a camera or its name", place_of(i),
                        in_quotes(sightings_[i].topic)));
      }
      find_minima(i, camera->second);
    }
    learn_noise();
    note_doubts();
    for (const Seen& seen : seen_) observe(seen);
    return std::move(out_);
  }

 private:
  struct Seen {
    std::size_t sighting;
    std::size_t camera;
    std::size_t minima;  ///< place among those of the camera
  };

  std::string place_of(std::size_t i) const {
    const std::string& place = sightings_[i].place;
    return place.empty() ? fmt::format("sighting {}", i) : place;
  }

  void find_minima(std::size_t i, std::size_t camera) {
    const CornerSighting& sighting = sightings_[i];
    const std::int64_t tag = tags_.tag_at(sighting.tag, sighting.stamp_s);
    if (tags_.ignored.count(tag) != 0) {
      ++out_.ignored;
      return;
    }
    const std::optional<double> size = tags_.size_of(tag);
    if (!size) {
      ++out_.without_size;
      return;
    }
    std::vector<TagMinimum> minima = tag_minima(
        in_apriltag_order(sighting.corners, settings_.order), *size, cameras_[camera].model);
    if (minima.empty()) {
      ++out_.without_pose;
      return;
    }
    seen_.push_back({i, camera, minima_[camera].size()});
    minima_[camera].push_back(std::move(minima));
  }

  void learn_noise() {
    const auto learned = [&](std::size_t camera) -> CameraCornerNoise {
      const MinimaOfSightings& minima = minima_[camera];
      const std::string& name = cameras_[camera].name;
      if (settings_.noise) return {name, *settings_.noise, minima.size(), CornerNoiseSource::given};
      if (minima.size() >= std::max<std::size_t>(settings_.least_sightings, 1))
        return {name, fit_corner_noise(minima).noise, minima.size(), CornerNoiseSource::own};
      if (seen_.size() >= std::max<std::size_t>(settings_.least_sightings, 1))
        return {name, noise_of_all(), minima.size(), CornerNoiseSource::all};
      return {name, settings_.assumed, minima.size(), CornerNoiseSource::assumed};
    };
    for (std::size_t camera = 0; camera < cameras_.size(); ++camera)
      out_.noise.push_back(learned(camera));
  }

  CornerNoise noise_of_all() {
    MinimaOfSightings all;
    for (const MinimaOfSightings& minima : minima_)
      all.insert(all.end(), minima.begin(), minima.end());
    return fit_corner_noise(all).noise;
  }

  void note_doubts() {
    const auto add = [&](std::vector<std::string> doubts) {
      out_.warnings.insert(out_.warnings.end(), doubts.begin(), doubts.end());
    };
    std::vector<std::vector<TagCorners>> corners(cameras_.size());
    std::vector<double> sizes;
    for (const Seen& seen : seen_) {
      const CornerSighting& sighting = sightings_[seen.sighting];
      corners[seen.camera].push_back(sighting.corners);
      sizes.push_back(*tags_.size_of(tags_.tag_at(sighting.tag, sighting.stamp_s)));
    }
    for (std::size_t camera = 0; camera < cameras_.size(); ++camera)
      add(internal::doubts_about_corners(
          {cameras_[camera], out_.noise[camera], minima_[camera], corners[camera]}));
    add(internal::doubts_about_sizes(sizes));
    add(internal::doubts_about_order(out_));
  }

  void observe(const Seen& seen) {
    const CornerSighting& sighting = sightings_[seen.sighting];
    Observation observation;
    observation.object = fmt::format("{}", tags_.tag_at(sighting.tag, sighting.stamp_s));
    observation.camera = cameras_[seen.camera].name;
    observation.detector = settings_.detector;
    observation.stamp_s = sighting.stamp_s;
    observation.components = tag_components(minima_[seen.camera][seen.minima],
                                            out_.noise[seen.camera].noise, settings_.least_weight);
    add_bearing_error(observation.components,
                      angle_of_pixels(cameras_[seen.camera].model, settings_.bearing_sd_px));
    out_.observations.push_back(std::move(observation));
  }

  std::span<const CornerSighting> sightings_;
  std::span<const RigCamera> cameras_;
  const TagMap& tags_;
  const FiducialSettings& settings_;
  std::vector<Seen> seen_;
  std::vector<MinimaOfSightings> minima_;  ///< of every camera
  Fiducials out_;
};

}  // namespace

std::size_t ambiguous_count(std::span<const Observation> observations) {
  return static_cast<std::size_t>(
      std::count_if(observations.begin(), observations.end(), [](const Observation& observation) {
        return observation.components[best_component(observation)].weight < kAmbiguousBelow;
      }));
}

Fiducials observe_fiducials(std::span<const CornerSighting> sightings,
                            std::span<const RigCamera> cameras, const TagMap& tags,
                            const FiducialSettings& settings) {
  if (cameras.empty()) throw InvalidInput("there is no camera, expected at least one");
  if (sightings.empty()) throw InvalidInput("there is no sighting, expected at least one");
  if (!(settings.least_weight >= 0.0 && settings.least_weight < 0.5)) {
    throw InvalidInput(fmt::format(
        "the least weight of a component is {}, expected one in [0, 0.5)", settings.least_weight));
  }
  kNotNegative.check(settings.bearing_sd_px, "bearing_sd_px");
  return Observer(sightings, cameras, tags, settings).run();
}

std::string format_rig(std::span<const RigCamera> cameras) {
  std::string text =
      fmt::format("camera,{},{}\n", internal::pose_header(), internal::covariance_header());
  for (const RigCamera& camera : cameras) {
    if (!camera.rig_camera) continue;
    text += fmt::format("{},{},{}\n", camera.name, internal::pose_fields(camera.rig_camera->pose),
                        internal::covariance_fields(camera.rig_camera->covariance));
  }
  return text;
}

std::string format_corner_noise(std::span<const CameraCornerNoise> noise) {
  std::string text = "camera,sd_px,dof,sightings,source\n";
  for (const CameraCornerNoise& camera : noise) {
    text += fmt::format("{},{:.6g},{:.6g},{},{}\n", camera.camera, camera.noise.sd_px,
                        camera.noise.dof, camera.sightings, word_of(camera.source));
  }
  return text;
}

std::string format_tag_priors(const TagMap& tags) {
  std::string text =
      fmt::format("id,size_m,{},{}\n", internal::pose_header(), internal::covariance_header());
  for (const auto& [id, prior] : tags.priors) {
    text += fmt::format("{},{},{},{}\n", id, tags.size_of(id).value_or(0.0),
                        internal::pose_fields(prior.pose),
                        internal::covariance_fields(prior.covariance));
  }
  return text;
}

}  // namespace posemix
