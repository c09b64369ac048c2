// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "trace_series.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "posemix/io/rigid.hpp"
#include "posemix/io/text.hpp"
#include "posemix/slam/frame_estimate.hpp"
#include "trace_names.hpp"

namespace posemix::internal {
namespace {

constexpr double kLogSdScale = 5e-3;
constexpr double kProbabilityScale = 1.0 / 65535.0;
constexpr ColumnFormat kCorrelationFormat{3, ColumnType::int16, 1.0 / 32767.0};

ColumnFormat position_format(const TraceScales& scales) {
  return {3, ColumnType::int32, scales.position_m};
}

ColumnFormat quaternion_format(const TraceScales& scales) {
  return {4, ColumnType::int16, scales.quaternion};
}

ColumnFormat sd_format(std::size_t width) {
  return {width, ColumnType::int16, kLogSdScale, ColumnMap::exponential};
}

class PoseSeries final : public TraceSeries {
 public:
  PoseSeries(std::string path, const std::string& prefix, const TraceScales& scales)
      : TraceSeries(std::move(path)), columns_(prefix, scales) {}
  void move_to(std::vector<TraceColumn>& columns) override { std::move(columns_).move_to(columns); }

 private:
  void read(const TracePlace& place) override {
    if (place.value().is_null()) return columns_.repeat_until(frames());
    columns_.add(columns_.read(place));
  }

  PoseColumns columns_;
};

class SdSeries final : public TraceSeries {
 public:
  SdSeries(std::string path, const std::string& prefix)
      : TraceSeries(std::move(path)), column_(prefix + "/log_sd", sd_format(6)) {}
  void move_to(std::vector<TraceColumn>& columns) override {
    columns.push_back(std::move(column_));
  }

 private:
  void read(const TracePlace& place) override {
    if (place.value().is_null()) return column_.repeat();
    std::array<double, 6> sd;
    place.numbers(sd);
    for (std::size_t i = 0; i < sd.size(); ++i) {
      if (sd[i] < 0.0) place.item(i).fail(fmt::format("{}", sd[i]), "no negative number");
    }
    column_.add(sd);
  }

  TraceColumn column_;
};

class PositionSeries final : public TraceSeries {
 public:
  PositionSeries(std::string path, const std::string& prefix)
      : TraceSeries(std::move(path)),
        sd_(prefix + "/position_log_sd", sd_format(3)),
        correlation_(prefix + "/position_correlation", kCorrelationFormat) {}
  void move_to(std::vector<TraceColumn>& columns) override {
    columns.push_back(std::move(sd_));
    columns.push_back(std::move(correlation_));
  }

 private:
  void read(const TracePlace& place) override {
    if (place.value().is_null()) {
      sd_.repeat();
      return correlation_.repeat();
    }
    std::array<double, 6> upper;
    place.numbers(upper);
    std::array<double, 3> sd;
    for (const auto& [axis, at] : {std::pair{0U, 0U}, {1U, 3U}, {2U, 5U}}) {
      if (upper[at] < 0.0) place.item(at).fail(fmt::format("{}", upper[at]), "a variance");
      sd[axis] = std::sqrt(upper[at]);
    }
    const auto correlation = [](double covariance, double a, double b) {
      return a * b > 0.0 ? covariance / (a * b) : 0.0;
    };
    sd_.add(sd);
    correlation_.add(std::array{correlation(upper[1], sd[0], sd[1]),
                                correlation(upper[2], sd[0], sd[2]),
                                correlation(upper[4], sd[1], sd[2])});
  }

  TraceColumn sd_;
  TraceColumn correlation_;
};

/// One number per frame.
class NumberSeries : public TraceSeries {
 public:
  NumberSeries(std::string path, const std::string& name, const ColumnFormat& format)
      : TraceSeries(std::move(path)), column_(name, format) {}
  void move_to(std::vector<TraceColumn>& columns) override {
    columns.push_back(std::move(column_));
  }

 protected:
  virtual double number(const TracePlace& place) = 0;

 private:
  void read(const TracePlace& place) final {
    if (place.value().is_null()) return column_.repeat();
    column_.add(std::array{number(place)});
  }

  TraceColumn column_;
};

class ProbabilitySeries final : public NumberSeries {
  using NumberSeries::NumberSeries;
  double number(const TracePlace& place) override { return place.probability(); }
};

class DistanceSeries final : public NumberSeries {
  using NumberSeries::NumberSeries;
  double number(const TracePlace& place) override {
    return place.number_in(0.0, std::numeric_limits<double>::max());
  }
};

class StatusSeries final : public NumberSeries {
  using NumberSeries::NumberSeries;
  double number(const TracePlace& place) override {
    const std::string name = place.value().is_string() ? place.value().get<std::string>() : "";
    if (name == kOldBirthName) return static_cast<double>(DetectionStatus::birth);
    for (const auto& [word, status] : words<DetectionStatus>) {
      if (word == name) return static_cast<double>(status);
    }
    place.fail(in_quotes(name), "the status of a detection");
  }
};

class HealthSeries final : public NumberSeries {
  using NumberSeries::NumberSeries;
  double number(const TracePlace& place) override {
    const std::string name = place.value().is_string() ? place.value().get<std::string>() : "";
    for (const auto& [word, health] : words<TrackHealth>) {
      if (word == name) return static_cast<double>(health);
    }
    place.fail(in_quotes(name), "the health of a track");
  }
};

class FlagSeries final : public NumberSeries {
  using NumberSeries::NumberSeries;
  double number(const TracePlace& place) override {
    if (!place.value().is_boolean()) place.fail(place.value().type_name(), "true or false");
    return place.value().get<bool>() ? 1.0 : 0.0;
  }
};

class SharesSeries final : public TraceSeries {
 public:
  SharesSeries(std::string path, std::string name)
      : TraceSeries(std::move(path)), name_(std::move(name)) {}
  void move_to(std::vector<TraceColumn>& columns) override {
    if (column_) columns.push_back(std::move(*column_));
  }

 private:
  void read(const TracePlace& place) override {
    if (place.value().is_null()) {
      if (column_) column_->repeat();
      return;
    }
    if (!column_) {
      if (place.size() == 0) place.fail("no probabilities", "at least one");
      column_.emplace(name_, ColumnFormat{place.size(), ColumnType::uint16, kProbabilityScale});
      column_->repeat_until(frames() - 1);
      shares_.resize(place.size());
    }
    place.numbers(shares_);
    for (std::size_t i = 0; i < shares_.size(); ++i) shares_[i] = place.item(i).probability();
    column_->add(shares_);
  }

  std::string name_;
  std::optional<TraceColumn> column_;
  std::vector<double> shares_;
};

}  // namespace

PoseColumns::PoseColumns(const std::string& prefix, const TraceScales& scales)
    : position_(prefix + "/position", position_format(scales)),
      quaternion_(prefix + "/quaternion", quaternion_format(scales)) {}

std::array<double, 7> PoseColumns::read(const TracePlace& place) const {
  constexpr double kNormTolerance = 1e-4;
  std::array<double, 7> pose;
  place.numbers(pose);
  for (std::size_t i = 0; i < 3; ++i) {
    place.item(i).number_in(-kFarthestPosition, kFarthestPosition);
    if (!position_.holds(pose[i])) throw PositionOutOfReach();
  }
  double squared = 0.0;
  for (std::size_t i = 3; i < 7; ++i) squared += pose[i] * pose[i];
  if (!(std::abs(std::sqrt(squared) - 1.0) <= kNormTolerance)) {
    place.fail(fmt::format("a quaternion of norm {:.6g}", std::sqrt(squared)), "norm 1");
  }
  return pose;
}

void PoseColumns::add(const std::array<double, 7>& pose) {
  double product = 0.0;
  for (std::size_t i = 0; i < 4; ++i) product += pose[3 + i] * last_[i];
  for (std::size_t i = 0; i < 4; ++i) last_[i] = product < 0.0 ? -pose[3 + i] : pose[3 + i];
  position_.add(std::span(pose).first<3>());
  quaternion_.add(last_);
}

void PoseColumns::repeat_until(std::size_t frames) {
  position_.repeat_until(frames);
  quaternion_.repeat_until(frames);
}

void PoseColumns::move_to(std::vector<TraceColumn>& columns) && {
  columns.push_back(std::move(position_));
  columns.push_back(std::move(quaternion_));
}

TraceSeriesPtr pose_series(std::string path, const std::string& prefix, const TraceScales& scales) {
  return std::make_unique<PoseSeries>(std::move(path), prefix, scales);
}

TraceSeriesPtr sd_series(std::string path, const std::string& prefix) {
  return std::make_unique<SdSeries>(std::move(path), prefix);
}

TraceSeriesPtr position_series(std::string path, const std::string& prefix) {
  return std::make_unique<PositionSeries>(std::move(path), prefix);
}

TraceSeriesPtr probability_series(std::string path, const std::string& name) {
  const ColumnFormat format{1, ColumnType::uint16, kProbabilityScale};
  return std::make_unique<ProbabilitySeries>(std::move(path), name, format);
}

TraceSeriesPtr distance_series(std::string path, const std::string& name) {
  return std::make_unique<DistanceSeries>(std::move(path), name, sd_format(1));
}

TraceSeriesPtr status_series(std::string path, const std::string& name) {
  return std::make_unique<StatusSeries>(std::move(path), name, ColumnFormat{});
}

TraceSeriesPtr health_series(std::string path, const std::string& name) {
  return std::make_unique<HealthSeries>(std::move(path), name, ColumnFormat{});
}

TraceSeriesPtr flag_series(std::string path, const std::string& name) {
  return std::make_unique<FlagSeries>(std::move(path), name, ColumnFormat{});
}

TraceSeriesPtr shares_series(std::string path, const std::string& name) {
  return std::make_unique<SharesSeries>(std::move(path), name);
}

}  // namespace posemix::internal
