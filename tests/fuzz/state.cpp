// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/state.hpp"
#include "base/checksum.hpp"
#include "base/state_parts.hpp"
#include "target.hpp"

/// Saved states: the first letter chooses the kind, and the bytes are those behind a head whose
/// checksum fits them, so that they are read; after an 'h' they are a whole state with a head of
/// their own. What is taken has the same bytes when it is written, and is configured as it was.
namespace posemix::fuzzing {
namespace {

constexpr std::size_t kHeadBytes = 48;

/// Before anything was seen.
template <class Slam>
const Slam& fresh() {
  static const Slam slam(PoseDensity(SE3d(), Matrix6d::Identity()), {{.id = "mug"}});
  return slam;
}

/// A head of this library before the bytes.
std::string with_head(std::string_view body, bool is_stamped) {
  static const std::string plain = state_bytes(fresh<MultiObjectSlam>());
  static const std::string stamped = state_bytes(fresh<StampedSlam>());
  std::string bytes = (is_stamped ? stamped : plain).substr(0, kHeadBytes);
  bytes += body;
  const auto size = internal::bytes_of(std::uint64_t{body.size()});
  const auto sum = internal::bytes_of(internal::crc64(body));
  std::copy(size.begin(), size.end(), bytes.begin() + 24);
  std::copy(sum.begin(), sum.end(), bytes.begin() + 32);
  return bytes;
}

template <class Slam>
void expect_kept(const Slam& slam) {
  const std::string written = state_bytes(slam);
  expect(state_info(written).is_stamped == std::is_same_v<Slam, StampedSlam>, "another kind");
  const Slam again = std::get<Slam>(slam_of_state(written));
  expect(state_bytes(again) == written, "another state after writing");
  expect(configuration_differences(again, slam).empty(), "another configuration after writing");
  for (const std::string& part : configuration_differences(slam, fresh<Slam>()))
    expect(!part.empty(), "a part of the configuration without a name");
}

}  // namespace

POSEMIX_FUZZ_TARGET(state) {
  const Choice choice(bytes);
  // What is no state at all is not called one.
  takes(choice.letter == 'h' ? "" : "the state", [&] {
    const SlamState slam = choice.letter == 'h'
                               ? slam_of_state(choice.rest)
                               : slam_of_state(with_head(choice.rest, choice.letter == 's'));
    std::visit([](const auto& one) { expect_kept(one); }, slam);
  });
}

}  // namespace posemix::fuzzing
