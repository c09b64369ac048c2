// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/expect_invalid.hpp"
#include "posemix/draw/picture.hpp"
#include "posemix/io/mixture_file.hpp"
#include "small_results.hpp"

/// Of the results of a run: picture.svg and posterior.json.
namespace posemix {
namespace {

using nlohmann::json;
using testing::replaced;

using testing::results;
using Results = testing::SmallResults;

TEST(Picture, IsWellFormedInEveryCase) {
  EXPECT_NE(results().files.at("picture.svg").find("<title>small 0001: gm-iekf (midway)</title>"),
            std::string::npos);
  SlamJob job = *results().job;
  job.name = "<&\"\xff";
  job.sequence.camera_truth.clear();
  for (ObjectRecording& object : job.sequence.objects) {
    object.relative_truth.clear();
    object.world_truth.clear();
  }
  const std::string plain =
      format_picture(job, *results().slam, evaluate(job.sequence, *results().slam));
  EXPECT_NE(plain.find("<title>&lt;&amp;&quot;?: gm-iekf (midway)</title>"), std::string::npos);
  EXPECT_NE(plain.find("no ground truth of the camera"), std::string::npos);
  EXPECT_EQ(std::count(plain.begin(), plain.end(), '<'),
            std::count(plain.begin(), plain.end(), '>'));
  EXPECT_EQ(plain.find("nan"), std::string::npos);
  EXPECT_EQ(plain.find("inf"), std::string::npos);
}

/// The recording, and nothing after its first frame.
Sequence first_frame(Sequence sequence) {
  const auto cut = [](auto& entries) {
    if (!entries.empty()) entries.erase(entries.begin() + 1, entries.end());
  };
  cut(sequence.stamps);
  cut(sequence.odometry);
  cut(sequence.camera_truth);
  cut(sequence.candidates);
  cut(sequence.observations);
  cut(sequence.images);
  for (ObjectRecording& object : sequence.objects) {
    cut(object.detections);
    cut(object.relative_truth);
    cut(object.world_truth);
  }
  return sequence;
}

TEST(Picture, OfOneFrame) {
  SlamJob job = *results().job;
  SlamRun single = *results().slam;
  single.frames.erase(single.frames.begin() + 1, single.frames.end());
  job.sequence = first_frame(std::move(job.sequence));
  const std::string picture = format_picture(job, single, results().metrics);
  EXPECT_EQ(picture.find("nan"), std::string::npos);
  EXPECT_EQ(picture.find("inf"), std::string::npos);
  // A time axis of no length has as many marks as stamps can tell apart.
  for (const double stamp : {0.0, 1e7, 1.7e9, 1e15}) {
    job.sequence.stamps = {stamp};
    const std::string one = format_picture(job, single, results().metrics);
    EXPECT_LT(one.size(), 2 * picture.size()) << stamp;
    EXPECT_EQ(one.find("time [s] since 1700000000.0") != std::string::npos, stamp == 1.7e9);
  }
}

// --- posterior.json

PosteriorFile reread(const std::string& text) { return parse_posterior(text, "p.json"); }

TEST(PosteriorFile, ReadsBackBitByBit) {
  const PosteriorFile written = last_posterior(*results().job, *results().slam);
  const PosteriorFile file = reread(results().files.at("posterior.json"));
  EXPECT_EQ(file.method, "gm-iekf (midway)");
  EXPECT_EQ(file.stamp, results().job->sequence.stamps.back());
  ASSERT_EQ(file.poses.size(), 4U);
  EXPECT_EQ(file.poses[0].name, "camera");
  EXPECT_EQ(file.poses[3].name, "can");
  EXPECT_EQ(file.poses[3].kind, PoseKind::object);
  ASSERT_EQ(file.mixture.size(), written.mixture.size());
  for (std::size_t i = 0; i < file.mixture.size(); ++i) {
    EXPECT_NEAR(file.mixture[i].log_weight, written.mixture[i].log_weight, 1e-13);
    EXPECT_EQ(file.mixture[i].density.covariance(), written.mixture[i].density.covariance());
    EXPECT_TRUE(file.mixture[i].density.mean().is_approx(written.mixture[i].density.mean(), 1e-15));
  }
}

TEST(PosteriorFile, NamesTheMotionOfConstantVelocity) {
  const Results moving({"motion={model='constant_velocity'}"});
  const PosteriorFile file = reread(moving.files.at("posterior.json"));
  ASSERT_EQ(file.poses.size(), 5U);
  EXPECT_EQ(file.poses[1].kind, PoseKind::camera_motion);
  EXPECT_EQ(file.poses[2].name, "mug");
}

TEST(PosteriorFile, NamesMustFitTheMixture) {
  PosteriorFile file = last_posterior(*results().job, *results().slam);
  file.poses.pop_back();
  EXPECT_INVALID(format_posterior(file), "posterior: 3 names for 4 poses");
}

TEST(PosteriorFile, RejectsWhatItDoesNotKnow) {
  json good = json::parse(results().files.at("posterior.json"));
  const auto with = [&](const char* pointer, const json& value) {
    json copy = good;
    copy[json::json_pointer(pointer)] = value;
    return copy.dump();
  };
  good["comment"] = "keys that are not known are ignored";
  EXPECT_NO_THROW(reread(good.dump()));
  EXPECT_INVALID(
      reread(with("/schema", 2)),
      "p.json: schema: got 2, expected 1: the file was written in another version of the format");
  EXPECT_INVALID(reread(with("/type", "posemix.trace")),
                 "p.json: type: got \"posemix.trace\", expected \"posemix.posterior\"");
  EXPECT_INVALID_WITH(reread(with("/perturbation/side", "right")),
                      "side: got \"right\", expected \"left\"");
  EXPECT_INVALID_WITH(reread(with("/perturbation/order", "trans_rot")), "order: got");
  EXPECT_INVALID_WITH(reread(with("/units/rotation", "deg")),
                      "rotation: got \"deg\", expected \"rad\"");
  EXPECT_INVALID_WITH(reread(with("/group", "SE(3)^3")),
                      "group: got \"SE(3)^3\", expected \"SE(3)^4\"");
  EXPECT_INVALID_WITH(reread(with("/poses/1/kind", "robot")),
                      "p.json: poses[1]: kind: got \"robot\"");
  EXPECT_INVALID_WITH(reread(with("/poses/1/name", "can")), "the object \"can\" again");
  EXPECT_INVALID_WITH(reread(with("/poses/0", good["poses"][1])), "as the first pose");
  EXPECT_INVALID_WITH(reread(with("/components", json::array())), "components: got no component");
  EXPECT_INVALID_WITH(reread(with("/components/0/poses/2/quaternion_xyzw/3", 3.0)), "norm");
  EXPECT_INVALID_WITH(reread(with("/components/0/covariance/3/3", -1.0)), "not positive definite");
  EXPECT_INVALID_WITH(reread(with("/components/0/covariance/3/4", 1.0)), "not symmetric");
  EXPECT_INVALID_WITH(reread(with("/components/0/covariance/0", json::array({1, 2}))),
                      "got 2 entries, expected 24");
  EXPECT_INVALID_WITH(reread(with("/components/0/log_weight", nullptr)),
                      "log_weight: got null, expected a number");
  EXPECT_INVALID_WITH(reread(with("/components/0/poses", json::array())),
                      "got 0 entries, expected 4");
}

TEST(PosteriorFile, HasTheWordForTheOrderThatMixtureFilesHave) {
  json file = json::parse(results().files.at("posterior.json"));
  EXPECT_EQ(file["perturbation"]["order"], word_of(TangentOrder::rotation_translation));
  file["perturbation"]["order"] = "rot_trans";  // of the release before
  EXPECT_EQ(reread(file.dump()).poses.size(), 4U);
}

TEST(PosteriorFile, RejectsDamagedFiles) {
  const std::string& good = results().files.at("posterior.json");
  EXPECT_INVALID_WITH(reread(""), "p.json: got a text that is not JSON");
  EXPECT_INVALID_WITH(reread(good.substr(0, good.size() / 2)), "not JSON");
  EXPECT_INVALID_WITH(reread("[1, 2]"), "p.json: got array, expected an object");
  EXPECT_INVALID_WITH(reread("{}"), "got no key 'type'");
  EXPECT_INVALID_WITH(reread(replaced(good, "\"log_weight\":", "\"log_weight\":1e999,\"x\":")),
                      "p.json");
  EXPECT_INVALID_WITH(read_posterior("/nowhere/p.json"), "/nowhere/p.json: cannot be read");
}
}  // namespace
}  // namespace posemix
