// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/state.hpp"

#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "base/checksum.hpp"
#include "base/state_layout.hpp"
#include "base/state_reader.hpp"
#include "base/state_writer.hpp"
#include "posemix/base/error.hpp"
#include "slam/stamped_state_fields.hpp"

namespace posemix {
namespace {

using internal::bytes_of;
using internal::number_of;

/// Text that is not of seven bits, and both ends of a line: what transfers as text change.
constexpr std::string_view kStateMagic("\x89PMXSTATE\r\n\x1a\n\0\0\0", 16);

/// The head: magic, format, kind, size and checksum of what follows, and its layout. Then the
/// version of the library by its length, and the payload.
constexpr std::size_t kHeadBytes = 16 + 4 + 4 + 8 + 8 + 8;

enum class StateKind : std::uint32_t { plain = 1, stamped = 2 };

template <class Slam>
constexpr StateKind kKind =
    std::is_same_v<Slam, StampedSlam> ? StateKind::stamped : StateKind::plain;

template <class Slam>
std::uint64_t layout_of() {
  static const std::uint64_t layout = internal::crc64(internal::LayoutWriter::of<Slam>());
  return layout;
}

void append(std::string& bytes, const auto& number) {
  const auto own = bytes_of(number);
  bytes.append(own.data(), own.size());
}

template <class Slam>
std::string bytes_of_state(const Slam& slam) {
  internal::StateWriter writer;
  writer(std::string(POSEMIX_VERSION), slam);
  const std::string body = std::move(writer).take();
  std::string bytes(kStateMagic);
  append(bytes, kStateFormat);
  append(bytes, static_cast<std::uint32_t>(kKind<Slam>));
  append(bytes, std::uint64_t{body.size()});
  append(bytes, internal::crc64(body));
  append(bytes, layout_of<Slam>());
  return bytes + body;
}

struct StateHead {
  StateKind kind;
  std::uint64_t size;
  std::uint64_t checksum;
  std::uint64_t layout;
};

StateHead head_of(std::string_view bytes) {
  if (!bytes.starts_with(kStateMagic.substr(0, std::min(bytes.size(), kStateMagic.size()))) ||
      bytes.empty()) {
    throw InvalidInput("this is not a saved state of posemix, expected one (posemix::state_bytes)");
  }
  if (bytes.size() < kHeadBytes) {
    throw InvalidInput(fmt::format("the state is cut off: it has {} bytes, expected a head of {}",
                                   bytes.size(), kHeadBytes));
  }
  const auto format = number_of<std::uint32_t>(bytes.substr(16));
  if (format != kStateFormat) {
    throw InvalidInput(fmt::format(
        "the state has the format {}, expected {}: it was saved by {} version of posemix", format,
        kStateFormat, format > kStateFormat ? "a later" : "an earlier"));
  }
  const auto kind = number_of<std::uint32_t>(bytes.substr(20));
  if (kind != static_cast<std::uint32_t>(StateKind::plain) &&
      kind != static_cast<std::uint32_t>(StateKind::stamped)) {
    throw InvalidInput(fmt::format("the state is of the kind {}, expected 1 or 2", kind));
  }
  return {static_cast<StateKind>(kind), number_of<std::uint64_t>(bytes.substr(24)),
          number_of<std::uint64_t>(bytes.substr(32)), number_of<std::uint64_t>(bytes.substr(40))};
}

constexpr std::string_view kOfState = "the state";

template <class Slam>
Slam slam_of_body(std::string_view body) {
  try {
    internal::StateReader reader(body);
    reader.take<std::string>();  // the version
    Slam slam = reader.take<Slam>();
    reader.finish();
    return slam;
  } catch (const InvalidInput& error) {
    // Parts of it check themselves, and do not know where they are.
    if (std::string_view(error.what()).starts_with(kOfState)) throw;
    throw InvalidInput(fmt::format("{} is damaged: {}", kOfState, error.what()));
  }
}

/// The bytes of anything that is a part of a state.
std::string part_bytes(const auto& part) {
  internal::StateWriter writer;
  writer(part);
  return std::move(writer).take();
}

}  // namespace

std::string state_bytes(const MultiObjectSlam& slam) { return bytes_of_state(slam); }

std::string state_bytes(const StampedSlam& slam) { return bytes_of_state(slam); }

std::string state_bytes(const ObjectSlam& slam) {
  if (const auto* tracker = std::get_if<MultiObjectSlam>(&slam.tracker()))
    return bytes_of_state(*tracker);
  throw InvalidInput(
      "the tracker has no state that can be saved, expected the multi-object filter");
}

StateInfo state_info(std::string_view bytes) {
  const StateHead head = head_of(bytes);
  internal::StateReader reader(bytes.substr(kHeadBytes));
  return {.format = kStateFormat,
          .version = reader.take<std::string>(),
          .is_stamped = head.kind == StateKind::stamped,
          .payload_bytes = head.size};
}

SlamState slam_of_state(std::string_view bytes) {
  const StateHead head = head_of(bytes);
  const std::string_view body = bytes.substr(kHeadBytes);
  if (body.size() != head.size) {
    throw InvalidInput(fmt::format("the state is {}: {} bytes follow its head, expected {}",
                                   body.size() < head.size ? "cut off" : "too long", body.size(),
                                   head.size));
  }
  if (const auto found = internal::crc64(body); found != head.checksum) {
    throw InvalidInput(fmt::format(
        "the state is damaged: its checksum is {:016x}, expected {:016x}", found, head.checksum));
  }
  const bool is_stamped = head.kind == StateKind::stamped;
  if (head.layout != (is_stamped ? layout_of<StampedSlam>() : layout_of<MultiObjectSlam>())) {
    throw InvalidInput(
        fmt::format("the state was saved by posemix {}, which lays it out otherwise; expected one "
                    "of posemix {}",
                    state_info(bytes).version, POSEMIX_VERSION));
  }
  if (is_stamped) return slam_of_body<StampedSlam>(body);
  return slam_of_body<MultiObjectSlam>(body);
}

std::vector<std::string> configuration_differences(const MultiObjectSlam& loaded,
                                                   const MultiObjectSlam& expected) {
  using Fields = internal::StateFields<MultiObjectSlam>;
  std::vector<std::string> differences;
  const auto& own = loaded.objects();
  const auto& others = expected.objects();
  for (std::size_t j = 0; j < others.size(); ++j) {
    if (j >= own.size() || part_bytes(own[j]) != part_bytes(others[j]))
      differences.push_back(fmt::format("object '{}'", others[j].id));
  }
  const auto& [settings] = Fields::settings(loaded);
  const auto& [other_settings] = Fields::settings(expected);
  // Objects that were met on the way are the last ones.
  for (std::size_t j = others.size(); j < own.size(); ++j)
    if (!settings.on_sight) differences.push_back(fmt::format("object '{}'", own[j].id));
  if (part_bytes(settings) != part_bytes(other_settings)) differences.emplace_back("settings");
  const auto& [motion] = Fields::motion(loaded);
  const auto& [other_motion] = Fields::motion(expected);
  if (part_bytes(motion) != part_bytes(other_motion)) differences.emplace_back("motion");
  if (Fields::records(loaded) != Fields::records(expected))
    differences.emplace_back("record_hypotheses");
  return differences;
}

std::vector<std::string> configuration_differences(const StampedSlam& loaded,
                                                   const StampedSlam& expected) {
  using Fields = internal::StateFields<StampedSlam>;
  const MultiObjectSlam& own = Fields::initial(loaded);
  auto differences = configuration_differences(own, Fields::initial(expected));
  // Before anything was seen there are none but those that were declared.
  const auto& [settings] = internal::StateFields<MultiObjectSlam>::settings(own);
  if (settings.on_sight) {
    for (std::size_t j = Fields::initial(expected).objects().size(); j < own.objects().size(); ++j)
      differences.push_back(fmt::format("object '{}'", own.objects()[j].id));
  }
  if (part_bytes(Fields::stamped(loaded)) != part_bytes(Fields::stamped(expected)))
    differences.emplace_back("stamped");
  return differences;
}

}  // namespace posemix
