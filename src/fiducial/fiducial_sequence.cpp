// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/fiducial/fiducial_sequence.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "io/toml_string.hpp"
#include "posemix/base/units.hpp"
#include "posemix/fiducial/tag_odometry.hpp"
#include "posemix/filter/object_prior.hpp"

namespace posemix {
namespace {

/// Standard deviations of odometry over a second where the sightings are too few to learn it.
constexpr double kUsualRotation = radians(0.3);
constexpr double kUsualTranslation = 0.02;
/// Below these learned ones are no better than luck.
constexpr double kLeastRotation = radians(0.02);
constexpr double kLeastTranslation = 0.5e-3;
/// A camera's pose with smaller deviations is exact.
constexpr double kExact = 1e-5;

std::string pose_list(const SE3d& pose) {
  const Eigen::Vector3d& t = pose.translation();
  const Eigen::Quaterniond& q = pose.rotation().quaternion();
  return fmt::format("[{:.9g}, {:.9g}, {:.9g}, {:.12g}, {:.12g}, {:.12g}, {:.12g}]", t.x(), t.y(),
                     t.z(), q.x(), q.y(), q.z(), q.w());
}

std::string triple(const Eigen::Vector3d& values) {
  return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", values.x(), values.y(), values.z());
}

std::string camera_tables(const std::vector<RigCamera>& cameras) {
  std::string text;
  for (const RigCamera& camera : cameras) {
    if (!camera.rig_camera) continue;
    text += fmt::format("\n[[cameras]]\nname = {}\npose = {}  # T_rig_camera\n",
                        internal::toml_string(camera.name), pose_list(camera.rig_camera->pose));
    if (!camera.rig_camera->covariance) continue;
    const Vector6d sd = camera.rig_camera->covariance->diagonal().cwiseSqrt();
    if (sd.maxCoeff() < kExact) continue;
    text += fmt::format("rotation_sd_deg = {}\ntranslation_sd_m = {}\n",
                        triple(sd.head<3>() / kRadPerDeg), triple(sd.tail<3>()));
  }
  return text;
}

std::string odometry_noise(const FiducialFolder& folder) {
  double rotation = kUsualRotation;
  double translation = kUsualTranslation;
  std::string_view from = "usual, for too few tags show it";
  if (const auto learned =
          fit_tag_odometry(folder.fiducials.observations, folder.cameras, folder.odometry)) {
    rotation = std::max(learned->rotation_sd, kLeastRotation);
    translation = std::max(learned->translation_sd, kLeastTranslation);
    from = "from the motion against single tags";
  }
  return fmt::format(
      "model = \"odometry\"\n"
      "# {}\n"
      "noise = {{per = \"second\", rotation_sd_deg = {:.4g}, translation_sd_m = {:.4g}}}\n",
      from, degrees(rotation), translation);
}

/// Known tags that were seen. A single one tells no more than where the world is: the map is then
/// in the frame of the rig's first pose, which is better known from the start.
std::string prior_tables(const FiducialFolder& folder) {
  std::size_t known = 0;
  std::set<std::string> seen;
  for (const Observation& observation : folder.fiducials.observations)
    seen.insert(observation.object);
  std::string text;
  for (const auto& [id, prior] : folder.tags.priors) {
    const std::string name = fmt::format("{}", id);
    if (seen.count(name) == 0 || !prior.covariance) continue;
    Vector6d floor;
    floor << Eigen::Vector3d::Constant(folder.sequence.survey_rotation_sd),
        Eigen::Vector3d::Constant(folder.sequence.survey_position_sd);
    const Vector6d sd = prior.covariance->diagonal().cwiseMax(floor.cwiseAbs2()).cwiseSqrt();
    ++known;
    text += fmt::format(
        "\n[[objects]]\nid = \"{}\"\nnoise = \"tag\"\n"
        "prior = {{pose = {}, rotation_sd_deg = {}, translation_sd_m = {}}}\n",
        name, pose_list(prior.pose), triple(sd.head<3>() / kRadPerDeg), triple(sd.tail<3>()));
  }
  return known > 1 ? text : "";
}

}  // namespace

std::string format_fiducial_sequence(const FiducialFolder& folder) {
  const std::string priors = prior_tables(folder);
  std::string text = "schema = 1\n";
  if (!folder.odometry.empty() || !priors.empty()) text += "\n[camera]  # of the rig\n";
  if (!folder.odometry.empty()) text += "odometry = \"odometry.tum\"\n";
  if (!priors.empty()) text += "start = {pose = \"unknown\"}  # found from known tags\n";
  text += fmt::format("\n[[observations]]\ncsv = \"{}\"\n",
                      folder.compress ? "observations.csv.gz" : "observations.csv");
  text += camera_tables(folder.cameras);
  text += "\n[motion]\n";
  if (folder.odometry.empty()) {
    text +=
        "model = \"random_walk\"\n"
        "# carried by hand or flown\n"
        "noise = {per = \"second\", rotation_sd_deg = 60.0, translation_sd_m = 1.0}\n";
  } else {
    text += odometry_noise(folder);
  }
  text +=
      "\n# A tag has two poses; the other places are for what is wrong.\n"
      "[filter]\n"
      "max_hypotheses = 4\n"
      "max_global_hypotheses = 2\n"
      "\n# The covariances of the observations take the place of the component's.\n"
      "[noise.tag]\n"
      "components = [{rotation_sd_deg = 1.0, translation_sd_m = 0.01}]\n"
      "clutter = {weight = 0.01, volume_m3 = 100.0}\n"
      "slow = \"none\"\n"
      "mode_time_s = 1.0\n"
      "\n[on_sight]  # tags of which nothing is known\n"
      "noise = \"tag\"\n";
  return text + priors;
}

}  // namespace posemix
