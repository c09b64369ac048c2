// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "mixture_folder.hpp"
#include "posemix/io/bop_views.hpp"
#include "posemix/io/text.hpp"

/// `posemix fuse-views`.
namespace posemix {
namespace {

using testing::contains;
using testing::ProgramResult;
using Json = nlohmann::json;

/// Four images around two objects; the second image shows the first one flipped.
class FuseViewsCommand : public testing::MixtureFolder {
 protected:
  FuseViewsCommand() {
    std::string cameras = "scene_id,im_id,tx,ty,tz,qx,qy,qz,qw\n";
    std::vector<BopRow> truth;
    for (int v = 0; v < 4; ++v) {
      const SE3d turn(SO3d::exp({0.0, 0.7 * v, 0.0}), Eigen::Vector3d::Zero());
      const SE3d camera = turn * SE3d(SO3d(), {0.0, 0.0, -0.8});
      const Eigen::Vector3d& t = camera.translation();
      const Eigen::Quaterniond& q = camera.rotation().quaternion();
      cameras += fmt::format("3,{},{},{},{},{},{},{},{}\n", 10 * v, t.x(), t.y(), t.z(), q.x(),
                             q.y(), q.z(), q.w());
      const SE3d flip(SO3d::exp({0.0, 0.0, v == 1 ? 3.14159265358979 : 0.0}),
                      Eigen::Vector3d::Zero());
      for (const std::int64_t object : {5, 9}) {
        truth.push_back({3, 10 * v, object, 0.9, camera.inverse() * world_object(object)});
        BopRow row = truth.back();
        if (object == 5) row.pose = row.pose * flip;
        rows_.push_back(row);
      }
    }
    folder_.put("cameras.csv", cameras);
    folder_.put("truth.csv", format_bop_rows(truth));
    folder_.put("single.csv", format_bop_rows(rows_));
    folder_.put("symmetries.toml",
                "schema = 1\n[symmetries.5]\ndiscrete = [{rotation_deg = [0, 0, 180]}]\n");
    folder_.put("targets.json", R"([{"scene_id": 3, "im_id": [["a", 0], ["a", 10], ["a", 20]]}])");
  }

  static SE3d world_object(std::int64_t object) {
    const double x = object == 5 ? 0.0 : 0.15;
    return SE3d(SO3d::exp({0.4, 0.1, 0.2}), {x, 0.05, 0.0});
  }
  Json instances(const std::string& arguments) const {
    const ProgramResult result = shell("posemix fuse-views single.csv " + arguments + " -o out");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(read_file(folder_ / "out/instances.json"))["groups"];
  }
  ProgramResult failure(const std::string& arguments) const {
    const ProgramResult result = shell("posemix fuse-views " + arguments + " -o out");
    EXPECT_EQ(result.out, "");
    return result;
  }

  std::vector<BopRow> rows_;
};

TEST_F(FuseViewsCommand, WritesPosesOfEveryImageAndMixtures) {
  for (const std::string source : {"--cameras cameras.csv", "--ground-truth truth.csv"}) {
    const Json groups = instances(source + " --groups 4");
    ASSERT_EQ(groups.size(), 1U);
    ASSERT_EQ(groups[0]["instances"].size(), 2U);
    const std::vector<BopRow> fused = read_bop_rows(folder_ / "out/fused.csv");
    ASSERT_EQ(fused.size(), 8U);
    for (const BopRow& row : fused) {
      for (const BopRow& single : rows_) {
        if (single.image != row.image || single.object != row.object) continue;
        const bool is_flipped = row.image == 10 && row.object == 5;
        EXPECT_EQ(row.pose.is_approx(single.pose, 1e-3), !is_flipped);
        EXPECT_GT(row.score, 0.9);
      }
    }
    for (const Json& instance : groups[0]["instances"]) {
      const MixtureFile file = parse_mixture(instance["mixture"].dump(), "mixture");
      EXPECT_EQ(file.frames.from, "world");
      EXPECT_NEAR(instance["supporting_views"].get<double>(), instance["obj_id"] == 5 ? 3.0 : 4.0,
                  0.2);
    }
    EXPECT_TRUE(contains(read_file(folder_ / "out/groups.csv"), "3,0,4,8,2,2,"));
  }
}

TEST_F(FuseViewsCommand, TakesSymmetriesAndTargets) {
  const Json declared = instances("--cameras cameras.csv --groups 4 --models-info symmetries.toml");
  for (const Json& instance : declared[0]["instances"])
    EXPECT_GT(instance["supporting_views"].get<double>(), 3.8);
  const Json chosen = instances("--cameras cameras.csv --targets targets.json --no-symmetries");
  EXPECT_EQ(chosen[0]["im_id"], Json({0, 10, 20}));
}

TEST_F(FuseViewsCommand, ReadsFoldersOfDatasets) {
  Json cameras, truth;
  for (const BopRow& row : parse_bop_rows(read_file(folder_ / "truth.csv"), "truth.csv")) {
    const auto numbers = [](const SE3d& pose) {
      const Eigen::Matrix3d r = pose.rotation().matrix().transpose();  // row by row
      const Eigen::Vector3d t = 1e3 * pose.translation();
      return std::pair(std::vector<double>(r.data(), r.data() + 9),
                       std::vector<double>(t.data(), t.data() + 3));
    };
    const std::string image = std::to_string(row.image);
    const auto [rotation, translation] = numbers(row.pose);
    truth[image].push_back(
        {{"obj_id", row.object}, {"cam_R_m2c", rotation}, {"cam_t_m2c", translation}});
    const auto [camera_r, camera_t] = numbers(row.pose * world_object(row.object).inverse());
    cameras[image] = {{"cam_R_w2c", camera_r}, {"cam_t_w2c", camera_t}};
  }
  folder_.put("with/test/000003/scene_camera.json", cameras.dump());
  folder_.put("with/models/models_info.json",
              R"({"5": {"diameter": 100, "symmetries_discrete":
                  [[-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]]}})");
  folder_.put("truth/val/000003/scene_gt.json", truth.dump());
  // The symmetries of the dataset are known, unless they are not to be.
  for (const auto& [arguments, agree] :
       {std::pair("--dataset with", 4.0), std::pair("--dataset with --no-symmetries", 3.0),
        std::pair("--dataset truth --split val", 3.0)}) {
    const Json groups = instances(std::string(arguments) + " --groups 4");
    ASSERT_EQ(groups[0]["instances"].size(), 2U) << arguments;
    for (const Json& instance : groups[0]["instances"]) {
      EXPECT_NEAR(instance["supporting_views"].get<double>(), instance["obj_id"] == 5 ? agree : 4.0,
                  0.2)
          << arguments;
    }
  }
  const ProgramResult missing = failure("single.csv --groups 4 --dataset with --split other");
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_TRUE(contains(missing.err, "000003")) << missing.err;
}

TEST_F(FuseViewsCommand, NamesWhatIsWrong) {
  EXPECT_EQ(failure("single.csv --cameras cameras.csv").exit_code, 2);
  EXPECT_EQ(failure("single.csv --groups 4").exit_code, 2);
  EXPECT_EQ(failure("single.csv --groups 4 --cameras cameras.csv --dataset .").exit_code, 2);
  folder_.put("few.csv", "scene_id,im_id,tx,ty,tz,qx,qy,qz,qw\n3,0,0,0,0,0,0,0,1\n");
  const ProgramResult few = failure("single.csv --groups 4 --cameras few.csv");
  EXPECT_EQ(few.exit_code, 3);
  EXPECT_TRUE(contains(few.err, "few.csv: has no camera pose of image 10 of scene 3")) << few.err;
  folder_.put("bad.csv", "scene_id,im_id,obj_id,score,R,t,time\n3,0,5,x,1,2,3\n");
  const ProgramResult bad = failure("bad.csv --groups 4 --cameras cameras.csv");
  EXPECT_EQ(bad.exit_code, 3);
  EXPECT_TRUE(contains(bad.err, "bad.csv:2: got")) << bad.err;
  std::string far = read_file(folder_ / "cameras.csv");
  far.replace(far.find("\n3,0,0,"), 7, "\n3,0,1e7,");
  folder_.put("far.csv", far);
  const ProgramResult lost = failure("single.csv --groups 4 --cameras far.csv");
  EXPECT_EQ(lost.exit_code, 3);
  EXPECT_TRUE(contains(lost.err, "single.csv: scene 3, images 0, 10, 20, 30: ")) << lost.err;
  folder_.put("noise.toml", "[noise.a]\ncomponents = []\n[noise.b]\ncomponents = []\n");
  const ProgramResult noise =
      failure("single.csv --groups 4 --cameras cameras.csv --noise noise.toml");
  EXPECT_EQ(noise.exit_code, 3);
  EXPECT_TRUE(contains(noise.err, "has 2 models, expected one")) << noise.err;
}

}  // namespace
}  // namespace posemix
