// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "trace_column.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace posemix::internal {
namespace {

struct TypeFacts {
  const char* name;
  std::size_t bytes;
  std::int64_t lowest;
  std::int64_t highest;
};

const TypeFacts& facts_of(ColumnType type) {
  static constexpr std::array<TypeFacts, 4> kFacts{{{"uint8", 1, 0, 255},
                                                    {"uint16", 2, 0, 65535},
                                                    {"int16", 2, -32767, 32767},
                                                    {"int32", 4, -2147483647, 2147483647}}};
  return kFacts[static_cast<std::size_t>(type)];
}

/// A difference modulo 2^bits as an unsigned number that is small if the difference is near zero,
/// on either side.
std::uint32_t folded(std::int64_t difference, std::size_t bits) {
  const std::size_t unused = 64 - bits;
  const auto shifted = static_cast<std::uint64_t>(difference) << unused;
  const std::int64_t in_range = static_cast<std::int64_t>(shifted) >> unused;
  return static_cast<std::uint32_t>(static_cast<std::uint64_t>(in_range) << 1U ^
                                    static_cast<std::uint64_t>(in_range >> 63));
}

}  // namespace

TraceColumn::TraceColumn(std::string name, const ColumnFormat& format)
    : name_(std::move(name)),
      format_(format),
      last_(format.width, 0),
      planes_(format.width * facts_of(format.type).bytes) {}

bool TraceColumn::holds(double value) const {
  const TypeFacts& facts = facts_of(format_.type);
  const double q = value / format_.scale;
  return q >= static_cast<double>(facts.lowest) - 0.5 &&
         q <= static_cast<double>(facts.highest) + 0.5;
}

std::int64_t TraceColumn::quantised(double value) const {
  const TypeFacts& facts = facts_of(format_.type);
  const double linear = format_.map == ColumnMap::linear ? value : std::log(value);
  return std::llround(std::clamp(linear / format_.scale, static_cast<double>(facts.lowest),
                                 static_cast<double>(facts.highest)));
}

void TraceColumn::add(std::span<const double> values) {
  const std::size_t bytes = facts_of(format_.type).bytes;
  for (std::size_t i = 0; i < format_.width; ++i) {
    const std::int64_t q = quantised(values[i]);
    const std::uint32_t difference = folded(q - last_[i], 8 * bytes);
    for (std::size_t byte = 0; byte < bytes; ++byte) {
      planes_[i * bytes + byte] += static_cast<char>(difference >> 8 * byte & 0xFFU);
    }
    last_[i] = q;
  }
}

void TraceColumn::repeat() { repeat_until(frames() + 1); }

void TraceColumn::repeat_until(std::size_t frames) {
  for (std::string& plane : planes_) plane.resize(std::max(frames, plane.size()), '\0');
}

Json TraceColumn::header() const {
  return {{"name", name_},
          {"width", format_.width},
          {"type", facts_of(format_.type).name},
          {"scale", format_.scale},
          {"map", format_.map == ColumnMap::linear ? "linear" : "exp"},
          {"fold", true}};
}

void TraceColumn::write(Deflater& out) const {
  for (const std::string& plane : planes_) out.add(plane);
}

}  // namespace posemix::internal
