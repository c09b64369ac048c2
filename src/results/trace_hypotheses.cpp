// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "trace_hypotheses.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "hypothesis_slots.hpp"
#include "posemix/base/error.hpp"

namespace posemix::internal {
namespace {

constexpr std::size_t kMostHypotheses = 1000;
/// Hypotheses of all entities and frames in memory: 42 MB.
constexpr std::size_t kMostRows = 1'500'000;
/// Bytes of a hypothesis in its columns, before they are compressed.
constexpr std::size_t kRowBytes = 27;

std::int32_t id_at(const TracePlace& place) {
  const double id = place.number_in(0.0, std::numeric_limits<std::int32_t>::max());
  if (id != std::floor(id)) place.fail(fmt::format("{}", id), "an integer");
  return static_cast<std::int32_t>(id);
}

std::size_t number_of_hypotheses(const TracePlace& place) {
  if (place.size() > kMostHypotheses) {
    place.fail(fmt::format("{} hypotheses", place.size()),
               fmt::format("at most {}", kMostHypotheses));
  }
  return place.size();
}

class AlternativesSeries final : public TraceSeries {
 public:
  AlternativesSeries(std::string path, const std::string& prefix, HypothesisStore& store)
      : TraceSeries(std::move(path)), store_(store), entity_(store.add_entity(prefix)) {}
  void move_to(std::vector<TraceColumn>& /*columns*/) override {}

 private:
  void read(const TracePlace& place) override {
    std::vector<TraceHypothesis> hypotheses;
    const std::size_t size = place.value().is_null() ? 0 : number_of_hypotheses(place);
    hypotheses.reserve(size);
    for (std::size_t i = 0; i < size; ++i) {
      const TracePlace item = place.item(i);
      const std::int32_t id = id_at(item.member("id"));
      const auto same = [id](const TraceHypothesis& other) { return other.id == id; };
      if (std::any_of(hypotheses.begin(), hypotheses.end(), same)) {
        item.fail(fmt::format("the id {} again", id), "another");
      }
      const double probability = item.member("probability").probability();
      hypotheses.push_back(store_.hypothesis(id, probability, item.member("pose")));
    }
    store_.add(entity_, std::move(hypotheses));
  }

  HypothesisStore& store_;
  std::size_t entity_;
};

}  // namespace

HypothesisStore::HypothesisStore(const TraceScales& scales)
    : scales_(scales), reader_("", scales) {}

std::size_t HypothesisStore::add_entity(std::string prefix, std::size_t frames) {
  entities_.push_back({std::move(prefix), std::vector<std::uint16_t>(frames, 0), {}});
  return entities_.size() - 1;
}

TraceHypothesis HypothesisStore::hypothesis(std::int32_t id, double probability,
                                            const TracePlace& pose) const {
  const std::array<double, 7> numbers = reader_.read(pose);
  TraceHypothesis hypothesis;
  hypothesis.id = id;
  hypothesis.probability =
      static_cast<std::uint16_t>(std::llround(65535.0 * std::min(1.0, probability)));
  for (std::size_t i = 0; i < 3; ++i) {
    hypothesis.position[i] =
        static_cast<std::int32_t>(std::llround(numbers[i] / scales_.position_m));
  }
  for (std::size_t i = 0; i < 4; ++i) {
    hypothesis.quaternion[i] =
        static_cast<std::int16_t>(std::llround(numbers[3 + i] / scales_.quaternion));
  }
  return hypothesis;
}

void HypothesisStore::add(std::size_t entity, std::vector<TraceHypothesis> hypotheses) {
  const auto heavier = [](const TraceHypothesis& a, const TraceHypothesis& b) {
    return a.probability > b.probability;
  };
  std::stable_sort(hypotheses.begin(), hypotheses.end(), heavier);
  if (hypotheses.size() > kept_) hypotheses.resize(kept_);
  Entity& own = entities_[entity];
  own.counts.push_back(static_cast<std::uint16_t>(hypotheses.size()));
  own.all.insert(own.all.end(), hypotheses.begin(), hypotheses.end());
  rows_ += hypotheses.size();
  if (rows_ > kMostRows) keep_most(kMostRows / 4 * 3);
}

/// Keeps at most so many hypotheses in all, or one of every frame.
void HypothesisStore::keep_most(std::size_t rows) {
  std::vector<std::size_t> frames_with(kMostHypotheses + 1, 0);  // by the number of hypotheses
  for (const Entity& entity : entities_) {
    for (const std::uint16_t count : entity.counts) ++frames_with[count];
  }
  std::size_t frames = 0;
  for (std::size_t count = 1; count <= kMostHypotheses; ++count) frames += frames_with[count];
  std::size_t kept = 0;
  std::size_t total = 0;
  while (frames > 0 && (kept == 0 || total + frames <= rows)) {
    total += frames;
    frames -= frames_with[++kept];
  }
  if (frames == 0) return;
  kept_ = kept;
  rows_ = 0;
  for (Entity& entity : entities_) {
    keep(entity);
    rows_ += entity.all.size();
  }
}

void HypothesisStore::keep(Entity& entity) const {
  auto from = entity.all.begin();
  auto to = entity.all.begin();
  for (std::uint16_t& count : entity.counts) {
    const auto least = static_cast<std::uint16_t>(std::min<std::size_t>(count, kept_));
    to = std::copy(from, from + least, to);
    from += count;
    count = least;
  }
  entity.all.erase(to, entity.all.end());
}

std::vector<TraceColumn> HypothesisStore::columns_of(const Entity& entity) const {
  HypothesisSlots slots(scales_);
  std::span<const TraceHypothesis> rest(entity.all);
  for (const std::uint16_t count : entity.counts) {
    slots.add(rest.first(count));
    rest = rest.subspan(count);
  }
  return std::move(slots).columns(entity.prefix);
}

std::size_t HypothesisStore::compressed_size() const {
  Deflater data;
  for (const Entity& entity : entities_) {
    for (const TraceColumn& column : columns_of(entity)) column.write(data);
  }
  return data.finish().size();
}

void HypothesisStore::write(std::size_t most_bytes, Deflater& data, Json& headers) {
  constexpr double kMargin = 0.95;
  while (kRowBytes * rows_ > most_bytes && kept_ > 1) {
    const std::size_t size = compressed_size();
    if (size <= most_bytes) break;
    const std::size_t before = kept_;
    keep_most(static_cast<std::size_t>(kMargin * static_cast<double>(most_bytes) *
                                       static_cast<double>(rows_) / static_cast<double>(size)));
    if (kept_ == before) break;
  }
  for (Entity& entity : entities_) {
    for (const TraceColumn& column : columns_of(entity)) {
      column.write(data);
      headers.push_back(column.header());
    }
    entity.all = {};
  }
}

std::optional<std::size_t> HypothesisStore::kept() const {
  return kept_ <= kMostHypotheses ? std::optional(kept_) : std::nullopt;
}

void JointHypotheses::read(const TracePlace& place) {
  const std::size_t size = place.value().is_null() ? 0 : number_of_hypotheses(place);
  std::vector<std::vector<TraceHypothesis>> of_pose(store_.size());
  for (std::size_t i = 0; i < size; ++i) {
    const TracePlace item = place.item(i);
    const double weight = item.member("weight").probability();
    const TracePlace poses = item.member("poses");
    if (poses.size() == 0) poses.fail("no poses", "the camera's and the objects'");
    if (store_.size() == 0) {
      for (std::size_t pose = 0; pose < poses.size(); ++pose) store_.add_entity("", frames() - 1);
      of_pose.resize(poses.size());
    }
    if (poses.size() != store_.size()) {
      poses.fail(fmt::format("{} poses", poses.size()), fmt::format("{}", store_.size()));
    }
    for (std::size_t pose = 0; pose < poses.size(); ++pose) {
      if (poses.value()[pose].is_null()) continue;
      of_pose[pose].push_back(
          store_.hypothesis(static_cast<std::int32_t>(i), weight, poses.item(pose)));
    }
  }
  for (std::size_t pose = 0; pose < store_.size(); ++pose)
    store_.add(pose, std::move(of_pose[pose]));
}

void JointHypotheses::name(const std::vector<std::string>& prefixes) {
  if (store_.size() > 0 && store_.size() != prefixes.size()) {
    throw InvalidInput(fmt::format("{}: got {} poses, expected {}: the camera's and the objects'",
                                   path(), store_.size(), prefixes.size()));
  }
  for (std::size_t pose = 0; pose < store_.size(); ++pose) store_.name(pose, prefixes[pose]);
}

TraceSeriesPtr alternatives_series(std::string path, const std::string& prefix,
                                   HypothesisStore& store) {
  return std::make_unique<AlternativesSeries>(std::move(path), prefix, store);
}

}  // namespace posemix::internal
