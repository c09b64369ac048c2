// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/state.hpp"
#include "base/checksum.hpp"
#include "base/state_parts.hpp"
#include "target.hpp"

/// Saved states: the first letter chooses the kind, and the bytes are those behind a head whose
/// checksum fits them, so that they are read. What is taken has the same bytes when it is written.
namespace posemix::fuzzing {
namespace {

constexpr std::size_t kHeadBytes = 48;

/// A head of this library before the bytes.
std::string with_head(std::string_view body, bool is_stamped) {
  static const PoseDensity camera(SE3d(), Matrix6d::Identity());
  static const std::string plain = state_bytes(MultiObjectSlam(camera, {{.id = "mug"}}));
  static const std::string stamped = state_bytes(StampedSlam(camera, {{.id = "mug"}}));
  std::string bytes = (is_stamped ? stamped : plain).substr(0, kHeadBytes);
  bytes += body;
  const auto size = internal::bytes_of(std::uint64_t{body.size()});
  const auto sum = internal::bytes_of(internal::crc64(body));
  std::copy(size.begin(), size.end(), bytes.begin() + 24);
  std::copy(sum.begin(), sum.end(), bytes.begin() + 32);
  return bytes;
}

}  // namespace

POSEMIX_FUZZ_TARGET(state) {
  const Choice choice(bytes);
  takes("the state", [&] {
    const std::string state = with_head(choice.rest, choice.letter == 's');
    const SlamState slam = slam_of_state(state);
    std::visit(
        [](const auto& one) {
          const std::string written = state_bytes(one);
          const SlamState again = slam_of_state(written);
          expect(state_bytes(std::get<std::decay_t<decltype(one)>>(again)) == written,
                 "another state after writing");
        },
        slam);
  });
}

}  // namespace posemix::fuzzing
