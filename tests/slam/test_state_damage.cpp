// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "base/checksum.hpp"
#include "base/state_layout.hpp"
#include "base/state_reader.hpp"
#include "base/state_writer.hpp"
#include "posemix/slam/state.hpp"
#include "posemix/testing/expect.hpp"
#include "slam/stamped_state_fields.hpp"
#include "state_scene.hpp"

/// States that are cut off, damaged, foreign, or hold what no state can.
namespace posemix {
namespace {

using testing::RichScene;
using testing::thrown_message;

constexpr std::size_t kHead = 48;

std::string message_of(const std::string& bytes) {
  return thrown_message([&] { slam_of_state(bytes); });
}

/// A short state of every kind of part.
const std::string& rich_state() {
  static const std::string bytes = [] {
    StampedSlam slam = RichScene::slam({.history_s = 0.3, .checkpoints = 1});
    for (const auto& input : RichScene(2).session(1.5)) testing::give(slam, input);
    slam.estimate();
    return state_bytes(slam);
  }();
  return bytes;
}

/// The same bytes with a checksum that fits them.
std::string with_checksum(std::string_view given) {
  std::string bytes(given);
  const auto sum = internal::bytes_of(internal::crc64(std::string_view(bytes).substr(kHead)));
  std::copy(sum.begin(), sum.end(), bytes.begin() + 32);
  const auto size = internal::bytes_of(std::uint64_t{bytes.size() - kHead});
  std::copy(size.begin(), size.end(), bytes.begin() + 24);
  return bytes;
}

TEST(StateDamage, TheChecksumIsThePublishedOne) {
  // The check value of CRC-64/XZ.
  EXPECT_EQ(internal::crc64("123456789"), 0x995DC9BBDF1939FAU);
}

TEST(StateDamage, WhatIsNoStateSaysWhatWasExpected) {
  const std::string expected =
      "this is not a saved state of posemix, expected one (posemix::state_bytes)";
  EXPECT_EQ(message_of(""), expected);
  EXPECT_EQ(message_of("[sequence]\nname = 'x'\n and much more of it than a head has"), expected);
  EXPECT_EQ(message_of(std::string(100, '\0')), expected);
  std::string text = rich_state();
  text.replace(text.find("\r\n"), 2, "\n");  // as a transfer as text does
  EXPECT_EQ(message_of(text), expected);
}

TEST(StateDamage, AStateThatIsCutOffSaysSo) {
  const std::string& bytes = rich_state();
  EXPECT_EQ(message_of(bytes.substr(0, 20)),
            "the state is cut off: it has 20 bytes, expected a head of 48");
  EXPECT_EQ(message_of(bytes.substr(0, 1000)),
            fmt::format("the state is cut off: 952 bytes follow its head, expected {}",
                        bytes.size() - kHead));
  EXPECT_EQ(message_of(bytes + "x"),
            fmt::format("the state is too long: {} bytes follow its head, expected {}",
                        bytes.size() - kHead + 1, bytes.size() - kHead));
}

TEST(StateDamage, AnImpossibleCovarianceIsRefused) {
  // A covariance of the camera with numbers that are nowhere else. Most of it is the error of the
  // world.
  Matrix6d covariance = Matrix6d::Identity() * 0.01234567891;
  covariance(0, 1) = covariance(1, 0) = 0.00123456789;
  const std::string bytes =
      state_bytes(StampedSlam(PoseDensity(SE3d(), covariance), {{.id = "mug"}}));
  const auto message_with = [&](double found, double other) {
    std::string damaged = bytes;
    const auto from = internal::bytes_of(found);
    const auto to = internal::bytes_of(other);
    const std::string_view pattern(from.data(), from.size());
    for (auto at = damaged.find(pattern); at != std::string::npos;
         at = damaged.find(pattern, at + to.size()))
      damaged.replace(at, to.size(), to.data(), to.size());
    return message_of(with_checksum(damaged));
  };
  const std::string expected =
      "the state is damaged: expected a covariance that is positive semi-definite";
  for (const double part : {0.01, 1.0 - 0.01}) {
    const double variance = part * covariance(0, 0);
    const double off_diagonal = part * covariance(0, 1);
    EXPECT_EQ(message_with(off_diagonal, off_diagonal), "");
    EXPECT_EQ(message_with(off_diagonal, 2.0 * variance), expected);  // a correlation of two
    EXPECT_EQ(message_with(variance, -variance), expected);
  }
}

/// Of two objects, with a camera whose position is known to `sd` [m].
StampedSlam slam_with_prior(double sd) {
  Matrix6d prior = Matrix6d::Identity();
  prior.bottomRightCorner<3, 3>() *= sd * sd;
  return StampedSlam(PoseDensity(SE3d(), prior), {{.id = "mug"}, {.id = "box"}});
}

TEST(StateDamage, WhatRoundingLeavesOfAWidePriorIsACovariance) {
  RandomStream random(9);
  for (const double sd : {1e1, 1e2, 1e3, 3e3, 1e4}) {
    StampedSlam slam = slam_with_prior(sd);
    for (int k = 0; k < 40; ++k) {
      for (const char* id : {"mug", "box"}) {
        Vector6d error;
        for (double& x : error) x = 0.002 * random.normal();
        const SE3d seen = SE3d::exp(error) * SE3d(SO3d(), {*id == 'm' ? 0.1 : -0.2, 0.0, 0.8});
        Observation one;
        one.object = id;
        one.components.push_back({.pose = seen});
        one.stamp_s = 0.1 * k;
        slam.add(one);
      }
      slam.estimate();
    }
    EXPECT_NO_THROW(slam_of_state(state_bytes(slam))) << "a prior of " << sd << " m";
  }
  // Wider, and rounding would leave covariances of the relative poses that are none.
  for (const double sd : {1e5, 4e5, 1e6, 3e6, 1e7}) {
    const std::string message = thrown_message([&] { slam_with_prior(sd); });
    EXPECT_TRUE(
        message.starts_with("object 'mug': the pose of the camera has a standard deviation"))
        << message;
  }
}

TEST(StateDamage, EveryByteIsGuarded) {
  const std::string& bytes = rich_state();
  for (std::size_t k = 0; k < bytes.size(); k += 1 + bytes.size() / 500) {
    std::string damaged = bytes;
    damaged[k] = static_cast<char>(damaged[k] ^ 0x10);
    EXPECT_THROW(slam_of_state(damaged), InvalidInput) << "byte " << k;
  }
  std::string damaged = bytes;
  damaged[bytes.size() / 2] = static_cast<char>(damaged[bytes.size() / 2] ^ 1);
  EXPECT_TRUE(message_of(damaged).starts_with("the state is damaged: its checksum is "));
}

TEST(StateDamage, OtherVersionsAreNamed) {
  std::string later = rich_state();
  later[16] = static_cast<char>(kStateFormat + 1);
  EXPECT_EQ(message_of(later),
            fmt::format("the state has the format {}, expected {}: it was saved by a later version "
                        "of posemix",
                        kStateFormat + 1, kStateFormat));
  std::string other = rich_state();
  other[40] = static_cast<char>(other[40] ^ 1);
  EXPECT_TRUE(message_of(other).starts_with("the state was saved by posemix "));
  EXPECT_NE(message_of(other).find("lays it out otherwise"), std::string::npos);
  std::string kind = rich_state();
  kind[20] = 9;
  EXPECT_EQ(message_of(kind), "the state is of the kind 9, expected 1 or 2");
}

TEST(StateDamage, InfoIsThatOfTheHead) {
  const StateInfo info = state_info(rich_state());
  EXPECT_EQ(info.format, kStateFormat);
  EXPECT_TRUE(info.is_stamped);
  EXPECT_EQ(info.payload_bytes, rich_state().size() - kHead);
  EXPECT_FALSE(info.version.empty());
}

TEST(StateDamage, BytesWithAChecksumOfTheirOwnAreRefusedOrAreAState) {
  // What passes the checksum is checked for itself: no index, size or number makes the reader take
  // what is not there. A changed number may be a state, from which the filter then goes on.
  const std::string& bytes = rich_state();
  RandomStream stream(1, 1);
  std::size_t refused = 0;
  constexpr int kCases = 300;
  for (int k = 0; k < kCases; ++k) {
    std::string damaged = bytes;
    const auto at = kHead + static_cast<std::size_t>(stream.uniform() *
                                                     static_cast<double>(bytes.size() - kHead));
    damaged[at] = static_cast<char>(static_cast<unsigned char>(stream.uniform() * 256.0));
    if (k % 5 == 0) damaged.resize(at);
    try {
      StampedSlam slam = std::get<StampedSlam>(slam_of_state(with_checksum(damaged)));
      slam.add_odometry(1e3, SE3d());
      slam.estimate();
    } catch (const std::exception&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, kCases / 5U);
  EXPECT_LT(refused, static_cast<std::size_t>(kCases));
}

template <class T>
T read_back(const auto& written) {
  internal::StateWriter writer;
  writer(written);
  const std::string bytes = std::move(writer).take();
  internal::StateReader reader(bytes);
  T x = reader.take<T>();
  reader.finish();
  return x;
}

TEST(StateDamage, ReadersTakeNoMemoryThatIsNotThere) {
  using Words = std::vector<std::string>;
  constexpr std::uint64_t kHuge = std::uint64_t{1} << 60U;
  EXPECT_EQ(
      thrown_message([&] { read_back<Words>(kHuge); }),
      "the state is damaged: 1152921504606846976 elements are announced where 0 bytes follow");
  EXPECT_EQ(thrown_message([&] { read_back<Eigen::MatrixXd>(std::pair(kHuge, kHuge)); }),
            "the state is damaged: a matrix of 1152921504606846976 x 1152921504606846976 does not "
            "fit");
  EXPECT_EQ(
      thrown_message([&] { read_back<Matrix6d>(Eigen::MatrixXd(Eigen::MatrixXd::Zero(5, 6))); }),
      "the state is damaged: a matrix of 5 x 6 does not fit");
  EXPECT_EQ(thrown_message([&] { read_back<NoiseFrame>(std::uint64_t{3}); }),
            "the state is damaged: 3 is no value of the choice that is expected");
  EXPECT_EQ(thrown_message([&] { read_back<std::optional<double>>('\2'); }),
            "the state is damaged: found 2, expected a 0 or a 1");
  EXPECT_EQ(thrown_message([&] { read_back<SO3d>(Eigen::Vector4d(0.0, 0.0, 0.1, 1.0)); }),
            "the state is damaged: expected a quaternion of length one");
  EXPECT_EQ(
      thrown_message([&] { read_back<std::shared_ptr<const std::string>>(std::uint64_t{7}); }),
      "the state is damaged: a reference to what comes later");
}

/// Those of tests/fuzz/corpus/state are bodies behind a letter, 's' for that of a StampedSlam. With
/// those of an earlier format the target would reach nothing.
TEST(StateDamage, SeedsOfTheFuzzTargetAreRead) {
  const std::string stamped = state_bytes(RichScene::slam());
  const std::string plain = state_bytes(RichScene::slam().slam());
  int read = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(POSEMIX_SOURCE_DIR "/tests/fuzz/corpus/state")) {
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string seed(std::istreambuf_iterator<char>(file), {});
    if (seed.starts_with('h')) continue;
    const std::string& head = seed.starts_with('s') ? stamped : plain;
    try {
      slam_of_state(with_checksum(head.substr(0, kHead) + seed.substr(1)));
      ++read;
    } catch (const InvalidInput&) {
      // Seeds that are damaged on purpose.
    }
  }
  EXPECT_GE(read, 5) << "make them anew from saved states";
}

TEST(StateDamage, TheLayoutBelongsToTheFormat) {
  // Where this fails, saved states have become other ones: raise kStateFormat, then put the new
  // number here.
  const std::string layout = internal::LayoutWriter::of<StampedSlam>();
  EXPECT_EQ(fmt::format("{} {:016x}", kStateFormat, internal::crc64(layout)), "6 49d2461b29e440f1");
}

}  // namespace
}  // namespace posemix
