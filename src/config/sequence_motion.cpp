// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"
#include "posemix/io/text.hpp"
#include "sequence_parts.hpp"

/// How objects move, and the frames that may hold them.
namespace posemix::internal {
namespace {

constexpr NumberRange kRate{.lowest = 0, .highest = 1e6};
constexpr NumberRange kVolume{.lowest = 1e-12, .highest = 1e12};
constexpr std::array<std::string_view, 6> kMotions{
    "static", "put_down", "random_walk", "constant_velocity", "attached", "calm_and_agile"};
constexpr std::size_t kCalmAndAgile = 5;

/// Six standard deviations from the keys `<prefix>rotation_sd_deg` and `<prefix>translation_sd_m`.
Vector6d read_sds(const TomlTable& table, const std::string& prefix, const Vector6d& otherwise) {
  Vector6d sds = otherwise;
  const std::string rotation = prefix + "rotation_sd_deg";
  const std::string translation = prefix + "translation_sd_m";
  if (table.has(rotation)) sds.head<3>() = read_sd(table, rotation, kSdOrZero, kRadPerDeg);
  if (table.has(translation)) sds.tail<3>() = read_sd(table, translation, kSdOrZero, 1.0);
  return sds;
}

PutDownMotion read_put_down(const TomlTable& table) {
  PutDownMotion motion;
  motion.jump_rate = table.get_double_or("jump_rate", motion.jump_rate, kRate);
  motion.volume_m3 = table.get_double_or("volume_m3", motion.volume_m3, kVolume);
  return motion;
}

RandomWalkMotion read_random_walk(const TomlTable& table) {
  RandomWalkMotion motion;
  motion.sds = read_sds(table, "", motion.sds);
  motion.frame = table.get_enum_or("frame", motion.frame);
  motion.break_rate = table.get_double_or("break_rate", motion.break_rate, kRate);
  return motion;
}

ConstantVelocityMotion read_constant_velocity(const TomlTable& table) {
  ConstantVelocityMotion motion;
  motion.acceleration_sds = read_sds(table, "acceleration_", motion.acceleration_sds);
  motion.frame = table.get_enum_or("frame", motion.frame);
  motion.start_sds = read_sds(table, "start_", motion.start_sds);
  motion.break_rate = table.get_double_or("break_rate", motion.break_rate, kRate);
  return motion;
}

AttachedMotion read_attached(const TomlTable& table, const std::vector<FrameFile>& frames) {
  AttachedMotion motion;
  const std::string name = table.get_string("frame");
  const auto found = std::ranges::find(frames, name, &FrameFile::name);
  if (found == frames.end())
    table.fail("frame",
               fmt::format("is {}, but no table [[frames]] has that name", in_quotes(name)));
  motion.frame = static_cast<std::size_t>(found - frames.begin());
  motion.slip_sds = read_sds(table, "slip_", motion.slip_sds);
  return motion;
}

/// One of the models of kMotions but the last.
ObjectMotion read_one(const TomlTable& table, const std::vector<FrameFile>& frames) {
  switch (table.get_word("model", std::span(kMotions).first(kCalmAndAgile))) {
    case 1:
      return read_put_down(table);
    case 2:
      return read_random_walk(table);
    case 3:
      return read_constant_velocity(table);
    case 4:
      return read_attached(table, frames);
    default:
      return StaticMotion{};
  }
}

}  // namespace

MotionModels read_object_motion(const TomlTable& object, const std::vector<FrameFile>& frames) {
  const auto table = object.find_table("motion");
  if (!table) return {};
  if (!table->has("models")) {
    if (table->get_word("model", kMotions) == kCalmAndAgile)
      return calm_and_agile(read_constant_velocity(*table));
    return {.models = {read_one(*table, frames)}};
  }
  if (table->has("model")) table->fail("model", "stands beside 'models', expected one of the two");
  MotionModels motion{.models = {}};
  for (const TomlTable& model : table->get_tables("models"))
    motion.models.push_back(read_one(model, frames));
  const auto count = static_cast<Eigen::Index>(motion.models.size());
  if (table->has("rates")) motion.rates = table->get_matrix("rates", count, count);
  if (table->has("start")) {
    const Eigen::VectorXd start = table->get_vector("start", count, kUnitInterval);
    motion.start.assign(start.begin(), start.end());
  }
  located(*table, table->has("rates") ? "rates" : "models", [&] { validate(motion); });
  return motion;
}

void check_motion(const TomlTable& object, const ObjectModel& model, const SlamJob& job,
                  const SlamMethod& method) {
  if (is_static(model.motion)) return;
  if (!std::holds_alternative<MultiObjectSlamSettings>(method.tracker)) {
    object.fail("motion",
                "is for filter.method = \"multi_object\"; no other filter has objects that move");
  }
  if (method.smoothing && method.smoothing->lag_frames > 0) {
    object.fail(
        "motion",
        "is for filter.smooth = \"none\" or \"full\"; objects that move are not smoothed by "
        "a fixed lag");
  }
  if (!has_own_track(model.motion)) return;
  const auto& settings = std::get<MultiObjectSlamSettings>(job.settings.tracker);
  located(object, "motion",
          [&] { MovingObjects(settings.moving, settings.frames).require_valid(model); });
}

std::vector<FrameFile> read_known_frames(const TomlTable& root, const FileFinder& files) {
  std::vector<FrameFile> frames;
  for (const TomlTable& table : root.find_tables("frames")) {
    const std::string name = table.get_string("name");
    if (name.empty()) table.fail("name", "is empty, expected the name of a frame");
    if (std::ranges::find(frames, name, &FrameFile::name) != frames.end())
      table.fail("name", fmt::format("is {}, which another frame has already", in_quotes(name)));
    const Vector6d sds = read_sds(table, "", Vector6d::Zero());
    frames.push_back({name, read_stamped(table, "poses", files, {.allow_misses = true}),
                      Matrix6d(sds.cwiseAbs2().asDiagonal())});
  }
  return frames;
}

FrameRecording FrameFile::on(const Timeline& timeline) const {
  FrameRecording recording{name, {}};
  for (const auto& pose : interpolated(timeline, file.poses)) {
    if (!pose) {
      recording.poses.emplace_back();
      continue;
    }
    const SE3d about(SO3d(), pose->translation());
    recording.poses.emplace_back(KnownFrame{*pose, about.adjoint_congruence(covariance)});
  }
  const auto first =
      std::ranges::find_if(recording.poses, [](const auto& p) { return p.has_value(); });
  if (first == recording.poses.end()) {
    throw InvalidInput(
        fmt::format("{}: no pose is between two frames of the recording, expected "
                    "stamps between {} and {} s",
                    file.name, timeline.stamps().front(), timeline.stamps().back()));
  }
  // Before its first pose the frame is there.
  std::fill(recording.poses.begin(), first, *first);
  return recording;
}

}  // namespace posemix::internal
