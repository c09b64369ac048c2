// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "engine.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "slam/searched_image.hpp"

namespace posemix::internal {
namespace {

/// Images in succession whose stamps have jumped, after which the clock is taken to have jumped:
/// not one wrong stamp.
constexpr std::size_t kJumped = 5;

StampedSlam slam_from(const LiveSettings& settings, const std::optional<SE3d>& odometry,
                      const std::vector<BodyCamera>& cameras) {
  MultiObjectSlamSettings tracker = settings.tracker;
  tracker.cameras = cameras;
  const bool at_odometry = settings.starts_at_odometry && odometry;
  const SE3d start = at_odometry ? *odometry : settings.start.mean();
  return StampedSlam(PoseDensity(start, settings.start.covariance()), settings.models, tracker,
                     settings.motion, settings.stamped);
}

}  // namespace

LiveEngine::LiveEngine(const LiveSettings& settings, bool records)
    : settings_(&settings),
      around_(settings),
      table_(settings.models, settings.tracker.on_sight.has_value()),
      recording_(records ? settings.report_images : 0) {
  slam_from(settings, std::nullopt, {});  // which throws for what is not valid
}

void LiveEngine::begin_again(const std::string& why) {
  ++counts_.resets;
  why_reset_ = why;
  slam_.reset();
  lacks_odometry_ = false;
  odometry_.clear();
  jumped_ = 0;
  recording_.clear();
}

void LiveEngine::reset() {
  begin_again("all is forgotten");
  waiting_.clear();
  around_.clear();
}

void LiveEngine::add(LiveImage image) {
  around_.see(image);
  // Images that have come late go before newer ones, as less is played again then; stamps that may
  // be of another clock do not.
  const std::int64_t near = nanoseconds(settings_->stamped.jump_back_s);
  auto place = waiting_.end();
  while (place != waiting_.begin()) {
    const std::int64_t newer = std::prev(place)->stamp_ns - image.stamp_ns;
    if (newer <= 0 || newer > near) break;
    --place;
  }
  waiting_.insert(place, std::move(image));
  while (waiting_.size() > settings_->node.queue_size) {
    waiting_.pop_front();
    ++counts_.dropped;
    complaint_ = "more images wait than queue_size";
  }
}

std::vector<LiveEstimate> LiveEngine::ready(double now_s, std::size_t most) {
  std::vector<LiveEstimate> found;
  for (std::size_t i = 0; i < waiting_.size() && found.size() < most;) {
    const std::size_t resets = counts_.resets;
    const bool is_over = now_s - waiting_[i].arrival_s >= settings_->node.transform_timeout_s;
    std::optional<ReadyImage> prepared;
    try {
      prepared = around_.ready(waiting_[i], is_over);
    } catch (const InvalidInput& error) {
      take_out(i);
      refuse(error.what());
      continue;
    }
    if (!prepared && !is_over) {
      ++i;
      continue;
    }
    take_out(i);
    if (auto estimate = settle(prepared)) found.push_back(std::move(*estimate));
    // A jump of the clock has taken images away.
    if (counts_.resets > resets) i = 0;
  }
  return found;
}

LiveImage LiveEngine::take_out(std::size_t i) {
  LiveImage image = std::move(waiting_[i]);
  waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(i));
  return image;
}

/// Takes in an image that has waited long enough; none prepared where its frame is not known.
std::optional<LiveEstimate> LiveEngine::settle(const std::optional<ReadyImage>& prepared) {
  if (!prepared) {
    ++counts_.dropped;
    complaint_ = around_.complaint();
    return std::nullopt;
  }
  if (!prepared->odometry && settings_->has_odometry()) {
    ++counts_.without_odometry;
    complaint_ = around_.complaint();
  }
  return take(*prepared);
}

/// A run whose camera is given begins where it is.
bool LiveEngine::lacks_given_pose(const ReadyImage& ready) const {
  return settings_->motion.model == MotionModel::given && settings_->starts_at_odometry &&
         !ready.odometry;
}

void LiveEngine::start(const ReadyImage& ready) {
  start_ns_ = newest_ns_ = ready.image.stamp_ns;
  lacks_odometry_ = settings_->has_odometry() && settings_->starts_at_odometry && !ready.odometry;
  slam_ = slam_from(*settings_, ready.odometry, around_.cameras());
}

std::optional<LiveEstimate> LiveEngine::take(const ReadyImage& ready) {
  if (const std::string why = slam_ ? jump_to(ready.image.stamp_ns) : ""; !why.empty())
    return jump(ready, why);
  // A world that began without odometry is not that of the odometry.
  if (slam_ && lacks_odometry_ && ready.odometry)
    begin_again("odometry has come: what was estimated without it is forgotten");
  if (!slam_ && lacks_given_pose(ready)) {
    ++counts_.dropped;
    complaint_ = around_.complaint();
    return std::nullopt;
  }
  if (!slam_) start(ready);
  try {
    put(ready);
  } catch (const InvalidInput& error) {
    refuse(error.what());
    return std::nullopt;
  }
  jumped_ = 0;
  ++counts_.images;
  try {
    return estimate(ready.image);
  } catch (const InvalidInput& error) {
    // What was taken in leads nowhere, and would stay.
    refuse(error.what());
    reset();
    why_reset_ = fmt::format("{}: all is forgotten", error.what());
    return std::nullopt;
  }
}

namespace {

/// Refuses an image before any of its detections is taken in.
void check_names(const LiveImage& image) {
  for (const LiveDetection& detection : image.detections) {
    require(!detection.class_id.empty(), "got a detection without a class, expected its name");
  }
}

}  // namespace

void LiveEngine::put(const ReadyImage& ready) {
  const LiveImage& image = ready.image;
  check_names(image);
  const double stamp_s = seconds(image.stamp_ns);
  const std::vector<Observation> observations = observations_of(image, stamp_s);
  const std::size_t too_late = slam_->counts().too_late;
  auto& known = odometry_[image.stamp_ns];
  if (ready.odometry && !known) {
    slam_->add_odometry(stamp_s, *ready.odometry);
    known = ready.odometry;
    newest_ns_ = std::max(newest_ns_, image.stamp_ns);
  }
  for (const Observation& observation : observations) {
    const StampAdmission admission = slam_->add(observation);
    newest_ns_ = std::max(newest_ns_, image.stamp_ns);
    ++counts_.observations;
    if (admission == StampAdmission::replayed) ++counts_.late;
    if (admission == StampAdmission::too_late) ++counts_.too_late;
  }
  const std::string camera = settings_->node.cameras.empty() ? "" : image.frame;
  const bool shows_nothing = observations.empty() && settings_->node.empty_is_image;
  // What other detectors find may be there all the same.
  const auto detector =
      settings_->sources.size() > 1 ? std::optional(image.detector) : std::nullopt;
  if (shows_nothing) {
    slam_->add_image(stamp_s, camera, detector);
    newest_ns_ = std::max(newest_ns_, image.stamp_ns);
  }
  if (slam_->counts().too_late > too_late) {
    if (observations.empty()) ++counts_.too_late;
    complaint_ = fmt::format(
        "an image is {:.1f} s older than the newest one, and history_s is {:g} s: it is left out",
        seconds(newest_ns_) - stamp_s, settings_->stamped.history_s);
    return;
  }
  recording_.add({image.stamp_ns, ready.odometry, observations,
                  shows_nothing ? std::optional(name_of({camera, detector})) : std::nullopt});
}

std::vector<Observation> LiveEngine::observations_of(const LiveImage& image, double stamp_s) {
  const std::vector<ClassTable::Row> rows = table_.assigned(image.detections);
  counts_.ignored += image.detections.size() - rows.size();
  std::vector<Observation> observations;
  observations.reserve(rows.size());
  for (const ClassTable::Row& row : rows) {
    const LiveDetection& detection = image.detections[row.detection];
    observations.push_back({.object = row.object,
                            .class_id = row.class_id,
                            .components = detection.components,
                            .camera = settings_->node.cameras.empty() ? "" : image.frame,
                            .detector = image.detector,
                            .stamp_s = stamp_s,
                            .score = detection.score});
  }
  return observations;
}

void LiveEngine::refuse(const std::string& why) {
  ++counts_.refused;
  complaint_ = why;
}

/// How a stamp has jumped; empty where it has not, and where the filter refuses it.
std::string LiveEngine::jump_to(std::int64_t stamp_ns) const {
  const StampedSlamSettings& of = settings_->stamped;
  const double stamp_s = seconds(stamp_ns);
  const double newest_s = seconds(newest_ns_);
  if (stamp_s > newest_s + of.jump_ahead_s)
    return fmt::format("the stamp is {:.1f} s after the newest one before it", stamp_s - newest_s);
  if (of.on_jump_back == StampJump::reset && stamp_s < newest_s - of.jump_back_s)
    return fmt::format("the stamp is {:.1f} s before the newest one", newest_s - stamp_s);
  return {};
}

/// The image is refused, or is the last of enough of them, with which a run begins.
std::optional<LiveEstimate> LiveEngine::jump(const ReadyImage& ready, const std::string& why) {
  const std::int64_t stamp_ns = ready.image.stamp_ns;
  const std::int64_t near = nanoseconds(settings_->stamped.jump_back_s);
  // Images of one clock are near each other, and of several moments.
  if (jumped_ == 0 || std::abs(static_cast<double>(stamp_ns) - static_cast<double>(jumped_to_ns_)) >
                          static_cast<double>(near)) {
    jumped_ = 1;
  } else if (stamp_ns != jumped_to_ns_) {
    ++jumped_;
  }
  jumped_to_ns_ = stamp_ns;
  if (jumped_ < kJumped) {
    refuse(fmt::format("{}; {} images in succession are taken for another clock", why, kJumped));
    return std::nullopt;
  }
  begin_again(why + ": all before is forgotten");
  std::erase_if(waiting_,
                [&](const LiveImage& image) { return std::abs(image.stamp_ns - stamp_ns) > near; });
  return take(ready);
}

std::optional<LiveEstimate> LiveEngine::estimate(const LiveImage& image) {
  const auto& found = slam_->finish();
  if (!found) return std::nullopt;
  const std::int64_t stamp_ns = start_ns_ + nanoseconds(found->stamp_s);
  odometry_.erase(odometry_.begin(),
                  odometry_.lower_bound(stamp_ns - nanoseconds(settings_->stamped.jump_back_s)));
  const auto odometry = odometry_.find(stamp_ns);
  LiveEstimate result{.stamp_ns = stamp_ns,
                      .arrival_s = image.arrival_s,
                      .frame = found->estimate,
                      .odometry = odometry == odometry_.end() ? std::nullopt : odometry->second,
                      .hypotheses = {},
                      .classes = {}};
  const MultiObjectSlam& slam = slam_->slam();
  for (std::size_t i = 0; i < slam.objects().size(); ++i) {
    auto& hypotheses = result.hypotheses.emplace_back();
    if (result.frame.objects[i]) hypotheses = slam.hypotheses(i);
    std::ranges::stable_sort(hypotheses, std::ranges::greater(), &ObjectHypothesis::probability);
    result.classes.push_back(class_of(slam.objects()[i]));
  }
  return result;
}

std::optional<LiveResult> LiveEngine::result() const {
  if (!slam_ || recording_.is_empty()) return std::nullopt;
  return result_of(recording_, *settings_, slam_->slam().objects(), around_.cameras());
}

}  // namespace posemix::internal
