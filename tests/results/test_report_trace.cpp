// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/expect_invalid.hpp"
#include "trace_folder.hpp"

/// Compares the trace of a report to trace.json.
namespace posemix {
namespace {

using nlohmann::json;
using testing::joint_trace;
using testing::kSmallFrames;
using testing::multi_object_trace;
using testing::ReportTrace;
using testing::SmallResults;
using testing::TraceFolder;

/// Compares poses up to the steps of position and quaternion, and the sign of the latter.
void expect_pose(const json& pose, const ReportTrace& trace, const std::string& prefix,
                 std::size_t k) {
  const auto& position = trace[prefix + "/position"][k];
  const auto& quaternion = trace[prefix + "/quaternion"][k];
  const double step = trace.header(prefix + "/position")["scale"];
  const double turn = trace.header(prefix + "/quaternion")["scale"];
  double product = 0.0;
  for (std::size_t i = 0; i < 4; ++i) product += quaternion[i] * pose[3 + i].get<double>();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(position[i], pose[i].get<double>(), 0.501 * step) << prefix << " " << k;
  }
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR((product < 0 ? -1 : 1) * quaternion[i], pose[3 + i].get<double>(), 0.501 * turn)
        << prefix << " " << k;
  }
}

void expect_poses(const json& poses, const ReportTrace& trace, const std::string& mask,
                  unsigned bit, const std::string& prefix) {
  for (std::size_t k = 0; k < kSmallFrames; ++k) {
    const bool there = poses.is_array() && !poses[k].is_null();
    EXPECT_EQ(trace.masked(mask, k, bit), there) << prefix << " " << k;
    if (there) expect_pose(poses[k], trace, prefix, k);
  }
}

void expect_deviations(const json& track, const ReportTrace& trace, const std::string& prefix) {
  for (std::size_t k = 0; k < kSmallFrames; ++k) {
    if (track["sd"][k].is_null()) continue;
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_NEAR(trace[prefix + "/log_sd"][k][i] / track["sd"][k][i].get<double>(), 1.0, 2.6e-3);
    }
    const auto upper = track["position_covariance"][k].get<std::vector<double>>();
    const auto& sd = trace[prefix + "/position_log_sd"][k];
    const auto& correlation = trace[prefix + "/position_correlation"][k];
    const auto covariance = [&](std::size_t c, std::size_t a, std::size_t b) {
      return correlation[c] * sd[a] * sd[b];
    };
    EXPECT_NEAR(sd[0] * sd[0] / upper[0], 1.0, 5.1e-3);
    EXPECT_NEAR(sd[1] * sd[1] / upper[3], 1.0, 5.1e-3);
    EXPECT_NEAR(sd[2] * sd[2] / upper[5], 1.0, 5.1e-3);
    const double tolerance = 5.2e-3 * (upper[0] + upper[3] + upper[5]);
    EXPECT_NEAR(covariance(0, 0, 1), upper[1], tolerance);
    EXPECT_NEAR(covariance(1, 0, 2), upper[2], tolerance);
    EXPECT_NEAR(covariance(2, 1, 2), upper[4], tolerance);
  }
}

void expect_track(const json& track, const ReportTrace& trace, const std::string& mask,
                  unsigned bit, const std::string& prefix) {
  expect_poses(track["pose"], trace, mask, bit, prefix);
  expect_poses(track["truth"], trace, mask, bit + 1, prefix + "/truth");
  expect_deviations(track, trace, prefix);
}

TEST(ReportTrace, HoldsPosesAndDeviations) {
  for (const json& trace : {joint_trace(), multi_object_trace()}) {
    const TraceFolder folder(trace);
    const json report = folder.report();
    for (const std::string key : {"name", "method", "conventions", "order", "frames", "stamps_s"}) {
      EXPECT_EQ(report["trace"][key], trace[key]) << key;
    }
    const ReportTrace packed = folder.trace();
    expect_track(trace["camera"], packed, "camera/mask", 0, "camera");
    for (const std::string id : {"mug", "box", "can"}) {
      const std::string prefix = "objects/" + id;
      const json& object = trace["objects"][id];
      expect_track(object["world"], packed, prefix + "/mask", 0, prefix + "/world");
      expect_track(object["relative"], packed, prefix + "/mask", 2, prefix + "/relative");
      expect_poses(object["detection"], packed, prefix + "/mask", 4, prefix + "/detection");
      for (std::size_t k = 0; k < kSmallFrames; ++k) {
        const auto status = static_cast<std::size_t>(packed[prefix + "/status"][k][0]);
        EXPECT_EQ(report["trace"]["statuses"][status], object["status"][k]);
      }
    }
  }
}

TEST(ReportTrace, HypothesesKeepTheirSlots) {
  const json& trace = multi_object_trace();
  const ReportTrace packed = TraceFolder(trace).trace();
  for (const auto& [id, object] : trace["objects"].items()) {
    const std::string prefix = "objects/" + id + "/hypotheses/";
    std::map<int, std::size_t> slots;  // by the hypothesis that was in it last
    for (std::size_t k = 0; k < kSmallFrames; ++k) {
      EXPECT_TRUE(packed.masked("objects/" + id + "/mask", k, 5));
      EXPECT_NEAR(packed["objects/" + id + "/mode_probability"][k][0],
                  object["mode_probability"][k].get<double>(), 0.51 / 65535.0);
      std::size_t found = 0;
      for (std::size_t slot = 0; packed.has(prefix + std::to_string(slot) + "/mask"); ++slot) {
        const std::string at = prefix + std::to_string(slot);
        if (!packed.masked(at + "/mask", k, 0)) continue;
        const int hypothesis = static_cast<int>(packed[at + "/id"][k][0]);
        EXPECT_EQ(slots.try_emplace(hypothesis, slot).first->second, slot);
        for (const json& expected : object["alternatives"][k]) {
          if (expected["id"] != hypothesis) continue;
          ++found;
          EXPECT_NEAR(packed[at + "/probability"][k][0], expected["probability"].get<double>(),
                      0.51 / 65535.0);
          expect_pose(expected["pose"], packed, at, k);
        }
      }
      EXPECT_EQ(found, object["alternatives"][k].size());
    }
  }
  EXPECT_FALSE(packed.has("camera/hypotheses/0/mask"));
}

TEST(ReportTrace, HoldsExistenceAndHealth) {
  const json& trace = multi_object_trace();
  const TraceFolder folder(trace);
  const json report = folder.report();
  const ReportTrace packed = folder.trace();
  for (const auto& [id, object] : trace["objects"].items()) {
    const std::string prefix = "objects/" + id;
    for (std::size_t k = 0; k < kSmallFrames; ++k) {
      const json& existence = object["existence"][k];
      EXPECT_EQ(packed.masked(prefix + "/mask", k, 6), !existence.is_null());
      if (!existence.is_null()) {
        EXPECT_NEAR(packed[prefix + "/existence"][k][0], existence.get<double>(), 0.51 / 65535.0);
      }
      const auto health = static_cast<std::size_t>(packed[prefix + "/health"][k][0]);
      EXPECT_EQ(report["trace"]["healths"][health], object["health"][k]);
      EXPECT_EQ(packed[prefix + "/register_again"][k][0] == 1.0, object["register_again"][k]);
    }
  }
  EXPECT_EQ(report["trace"]["models"], json::object());
  json wrong = trace;
  wrong["objects"]["mug"]["health"][1] = "well";
  EXPECT_INVALID_WITH(TraceFolder(wrong).report(), "mug: health[1]: got \"well\"");
  wrong = trace;
  wrong["objects"]["mug"]["register_again"][0] = 1;
  EXPECT_INVALID_WITH(TraceFolder(wrong).report(), "register_again[0]");
}

TEST(ReportTrace, HoldsTheModelsOfAnObjectThatMoves) {
  const json trace = json::parse(
      testing::SmallResults({"filter={}", "objects.mug.motion={model='calm_and_agile'}"})
          .files.at("trace.json"));
  const json& mug = trace["objects"]["mug"];
  const TraceFolder folder(trace);
  EXPECT_EQ(folder.report()["trace"]["models"], json({{"mug", mug["model_names"]}}));
  const ReportTrace packed = folder.trace();
  std::size_t known = 0;
  for (std::size_t k = 0; k < kSmallFrames; ++k) {
    EXPECT_EQ(packed.masked("objects/mug/mask", k, 7), !mug["models"][k].is_null());
    if (mug["models"][k].is_null()) continue;
    ++known;
    for (std::size_t model = 0; model < 2; ++model)
      EXPECT_NEAR(packed["objects/mug/models"][k][model], mug["models"][k][model].get<double>(),
                  0.51 / 65535.0);
  }
  EXPECT_GT(known, 0U);
  EXPECT_FALSE(packed.has("objects/box/models"));
  json wrong = trace;
  wrong["objects"]["mug"]["models"].back() = {0.1, 0.2, 0.7};
  EXPECT_INVALID_WITH(TraceFolder(wrong).report(), "got 3 entries, expected 2");
}

TEST(ReportTrace, JointHypothesesBecomeThoseOfEachObject) {
  const json& trace = joint_trace();
  const ReportTrace packed = TraceFolder(trace).trace();
  const std::vector<std::string> prefixes{"camera", "objects/mug", "objects/box", "objects/can"};
  std::size_t most = 0;
  for (std::size_t k = 0; k < kSmallFrames; ++k) {
    most = std::max(most, trace["hypotheses"][k].size());
    for (std::size_t pose = 0; pose < prefixes.size(); ++pose) {
      for (std::size_t rank = 0; rank < trace["hypotheses"][k].size(); ++rank) {
        const std::string at = prefixes[pose] + "/hypotheses/" + std::to_string(rank);
        const json& hypothesis = trace["hypotheses"][k][rank];
        EXPECT_EQ(packed.masked(at + "/mask", k, 0), !hypothesis["poses"][pose].is_null());
        if (hypothesis["poses"][pose].is_null()) continue;
        EXPECT_EQ(packed[at + "/id"][k][0], static_cast<double>(rank));
        EXPECT_NEAR(packed[at + "/probability"][k][0], hypothesis["weight"].get<double>(),
                    0.51 / 65535.0);
        expect_pose(hypothesis["poses"][pose], packed, at, k);
      }
    }
  }
  EXPECT_GT(most, 1U);
  EXPECT_FALSE(packed.has("camera/hypotheses/" + std::to_string(most) + "/mask"));
}

TEST(ReportTrace, SlotsOfTheDeadAreUsedAgain) {
  json trace = multi_object_trace();
  const json pose = json::array({0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 1.0});
  const auto alternatives = [&](const std::vector<int>& ids) {
    json list = json::array();
    for (const int id : ids) list.push_back({{"id", id}, {"probability", 0.1}, {"pose", pose}});
    return list;
  };
  json& mug = trace["objects"]["mug"]["alternatives"];
  for (std::size_t k = 0; k < kSmallFrames; ++k) mug[k] = alternatives({5});
  mug[0] = alternatives({});
  mug[2] = alternatives({7, 5});
  mug[3] = alternatives({9, 7});
  const ReportTrace packed = TraceFolder(trace).trace();
  const auto in_slot = [&](std::size_t slot, std::size_t frame) {
    const std::string at = "objects/mug/hypotheses/" + std::to_string(slot);
    return packed.masked(at + "/mask", frame, 0) ? static_cast<int>(packed[at + "/id"][frame][0])
                                                 : -1;
  };
  EXPECT_EQ(in_slot(0, 0), -1);
  EXPECT_EQ(in_slot(0, 1), 5);
  EXPECT_EQ(in_slot(0, 2), 5);
  EXPECT_EQ(in_slot(1, 2), 7);
  EXPECT_EQ(in_slot(0, 3), 9);
  EXPECT_EQ(in_slot(1, 3), 7);
  EXPECT_EQ(in_slot(0, 4), 5);
  EXPECT_EQ(in_slot(1, 4), -1);
  EXPECT_FALSE(packed.has("objects/mug/hypotheses/2/mask"));
}

TEST(ReportTrace, WithoutTruthAndWithoutCovariancesOfPositions) {
  json trace = joint_trace();
  trace["camera"]["truth"] = nullptr;
  trace["camera"].erase("position_covariance");
  const ReportTrace packed = TraceFolder(trace).trace();
  EXPECT_FALSE(packed.has("camera/truth/position"));
  EXPECT_FALSE(packed.has("camera/position_correlation"));
  EXPECT_TRUE(packed.has("camera/log_sd"));
  EXPECT_FALSE(packed.masked("camera/mask", 0, 1));
}

TEST(ReportTrace, TheNamesOfTheReleaseBeforeAreRead) {
  json old = multi_object_trace();
  for (json& object : old["objects"]) {
    json statuses = std::move(object["status"]);
    object.erase("status");
    for (json& status : statuses) {
      if (status == "birth") status = "born";
    }
    statuses[1] = "born";
    object["fate"] = std::move(statuses);
  }
  json now = multi_object_trace();
  for (json& object : now["objects"]) object["status"][1] = "birth";
  std::vector<std::string> warnings;
  EXPECT_EQ(TraceFolder(old).report(&warnings)["trace"], TraceFolder(now).report()["trace"]);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("trace.json: key 'fate' is now 'status'; "), std::string::npos);
  old["objects"].front()["status"] = now["objects"].front()["status"];
  EXPECT_INVALID_WITH(TraceFolder(old).report(), "status: got the key again, expected it once");
}

TEST(ReportTrace, TheOrderOfKeysDoesNotMatter) {
  // nlohmann::json sorts keys: frames and hypotheses come before the objects and their order.
  const std::string text = SmallResults().files.at("trace.json");
  ASSERT_LT(text.find("\"objects\""), text.find("\"hypotheses\":[["));
  const std::string sorted_text = joint_trace().dump();
  ASSERT_GT(sorted_text.find("\"objects\""), sorted_text.find("\"hypotheses\":[["));
  const ReportTrace sorted = TraceFolder(sorted_text).trace();
  const ReportTrace written = TraceFolder(text).trace();
  EXPECT_TRUE(sorted.columns() == written.columns());
}

TEST(ReportTrace, StepsAreFine) {
  const ReportTrace packed = TraceFolder(joint_trace()).trace();
  const auto scale = [&](const std::string& name) {
    return packed.header(name)["scale"].get<double>();
  };
  for (const std::string pose : {"camera", "camera/truth", "objects/mug/relative"}) {
    EXPECT_EQ(scale(pose + "/position"), 1e-5);
    EXPECT_EQ(scale(pose + "/quaternion"), 1.0 / 32767.0);
  }
  for (const std::string pose : {"camera/hypotheses/0", "objects/mug/detection"}) {
    EXPECT_NEAR(scale(pose + "/position"), 1e-4, 1e-18);
    EXPECT_EQ(scale(pose + "/quaternion"), 1.0 / 8191.0);
  }
  EXPECT_EQ(scale("camera/log_sd"), 5e-3);
}

TEST(ReportTrace, FarPositionsTakeACoarserStep) {
  json trace = joint_trace();
  trace["camera"]["pose"][7] = json::array({-4e6, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0});
  const ReportTrace packed = TraceFolder(trace).trace();
  EXPECT_NEAR(packed.header("camera/position")["scale"].get<double>(), 1e-2, 1e-12);
  expect_poses(trace["camera"]["pose"], packed, "camera/mask", 0, "camera");
}

}  // namespace
}  // namespace posemix
