// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "trace_series.hpp"

namespace posemix::internal {

/// A hypothesis of one frame, in the integers of its columns.
struct TraceHypothesis {
  std::int32_t id = 0;
  std::array<std::int32_t, 3> position{};
  std::array<std::int16_t, 4> quaternion{};
  std::uint16_t probability = 0;
};

/// Hypotheses of several entities over the frames, for columns `prefix`/hypotheses/k/... A
/// hypothesis keeps its slot k as long as it lives, so that the values of a slot change little from
/// frame to frame. Memory and stream have a limit: where there are more hypotheses, those that are
/// the heaviest of their frame are kept, so many of every frame and entity.
class HypothesisStore {
 public:
  explicit HypothesisStore(const TraceScales& scales);

  /// One more entity, whose first `frames` frames have none. Returns its index.
  std::size_t add_entity(std::string prefix, std::size_t frames = 0);
  void name(std::size_t entity, std::string prefix) {
    entities_[entity].prefix = std::move(prefix);
  }
  std::size_t size() const { return entities_.size(); }

  /// @throws InvalidInput as PoseColumns::read
  TraceHypothesis hypothesis(std::int32_t id, double probability, const TracePlace& pose) const;
  /// Adds the hypotheses of the next frame of an entity.
  void add(std::size_t entity, std::vector<TraceHypothesis> hypotheses);

  /// Compresses all as columns, in about as many bytes as `most_bytes` or fewer.
  void write(std::size_t most_bytes, Deflater& data, Json& headers);
  /// The largest number of hypotheses of a frame and entity, where some were left out.
  std::optional<std::size_t> kept() const;

 private:
  struct Entity {
    std::string prefix;
    std::vector<std::uint16_t> counts;  ///< by frame
    std::vector<TraceHypothesis> all;   ///< frame by frame
  };

  void keep_most(std::size_t rows);
  void keep(Entity& entity) const;
  std::size_t compressed_size() const;
  std::vector<TraceColumn> columns_of(const Entity& entity) const;

  TraceScales scales_;
  PoseColumns reader_;
  std::vector<Entity> entities_;
  std::size_t rows_ = 0;
  std::size_t kept_ = std::numeric_limits<std::size_t>::max();
};

/// The alternatives of one object, whose columns the store writes.
TraceSeriesPtr alternatives_series(std::string path, const std::string& prefix,
                                   HypothesisStore& store);

/// Joint hypotheses: poses of the camera and of every object. They become hypotheses of
/// every entity separately, whose ids are their ranks.
class JointHypotheses final : public TraceSeries {
 public:
  JointHypotheses(std::string path, const TraceScales& scales)
      : TraceSeries(std::move(path)), store_(scales) {}

  /// The entities of the poses ("camera", "objects/mug", ...), in their order.
  /// @throws InvalidInput when the number of poses is different
  void name(const std::vector<std::string>& prefixes);
  /// Call name() first.
  HypothesisStore& store() { return store_; }
  void move_to(std::vector<TraceColumn>& /*columns*/) override {}

 private:
  void read(const TracePlace& place) override;

  HypothesisStore store_;  ///< an entity per pose; none until the first hypothesis
};

}  // namespace posemix::internal
