// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/temporary_folder.hpp"
#include "posemix/testing/expect.hpp"
#include "study/fiducials/peer.hpp"
#include "study/fiducials/study.hpp"
#include "tag_files.hpp"

namespace posemix {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr const char* kSightings =
    "stamp_s,camera,id,tx_m,ty_m,tz_m,qx,qy,qz,qw\n"
    "0.5,left,7,1,2,3,0,0,0,1\n";

/// A peer whose result are the files of a folder.
FiducialPeer copying_peer(const testing::TemporaryFolder& folder) {
  return {
      "copy",
      "sh '" + folder.put("copy.sh", "cp -r \"$(dirname \"$0\")/result\" \"$2\"\n").string() + "'"};
}

FiducialEstimate run_in(const testing::TemporaryFolder& folder, const FiducialPeer& peer) {
  return run_peer(peer, folder.path(), folder / "it's out");
}

TEST(FiducialsPeer, ReadsWhatThePeerWrote) {
  const testing::TemporaryFolder folder;
  folder.put("result/camera.tum", "0.5 1 0 0 0 0 0 1\n0.6 2 0 0 0 0 0 1\n");
  folder.put("result/sightings.csv", kSightings);
  const FiducialPeer peer = copying_peer(folder);
  const FiducialEstimate least = run_in(folder, peer);
  ASSERT_EQ(least.camera.size(), 2U);
  EXPECT_EQ(least.camera[1].pose->translation().x(), 2.0);
  ASSERT_EQ(least.sightings.size(), 1U);
  EXPECT_EQ(least.sightings[0].stamp_s, 0.5);
  EXPECT_EQ(least.sightings[0].camera, "left");
  EXPECT_EQ(least.sightings[0].tag, "7");
  EXPECT_EQ(least.sightings[0].pose.translation(), Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_TRUE(least.tags.empty());
  EXPECT_FALSE(least.times.has_value());
  std::filesystem::remove_all(folder / "it's out");
  folder.put("result/tags.csv", "id,tx_m,ty_m,tz_m,qx,qy,qz,qw\n7,4,0,0,0,0,0,1\n");
  folder.put("result/times.csv", "frames,processor_s,worst_s\n2,0.25,0.2\n");
  const FiducialEstimate all = run_in(folder, peer);
  EXPECT_EQ(all.tags.at("7").translation().x(), 4.0);
  EXPECT_EQ(all.times->frames, 2U);
  EXPECT_EQ(all.times->processor_s, 0.25);
  EXPECT_EQ(all.times->worst_s, 0.2);
}

TEST(FiducialsPeer, SaysWhyAPeerFailed) {
  const testing::TemporaryFolder folder;
  const auto message = [&](const std::string& command) {
    return testing::thrown_message([&] { run_in(folder, {"odd", command}); });
  };
  const std::string failed = message("echo one; echo no tags; exit 3;");
  EXPECT_NE(failed.find("peer 'odd'"), std::string::npos) << failed;
  EXPECT_NE(failed.find("failed: no tags"), std::string::npos) << failed;
  EXPECT_NE(message("true").find("camera.tum"), std::string::npos);
  folder.put("result/camera.tum", "0 1 0 0 0 0 0 1\n");
  folder.put("result/sightings.csv", "stamp_s,camera\n0,left\n");
  const std::string column = message(copying_peer(folder).command);
  EXPECT_NE(column.find("sightings.csv"), std::string::npos) << column;
  EXPECT_NE(column.find("id"), std::string::npos) << column;
}

TEST(FiducialsPeer, OdometryContinuesAPathBetweenItsPoses) {
  const SE3d turn(SO3d::exp({0.0, 0.0, 0.5}), {0.0, 0.0, 0.0});
  std::vector<StampedPose> odometry;
  for (int k = 0; k < 5; ++k) odometry.push_back({0.1 * k, SE3d(SO3d(), {1.0 * k, 0.0, 0.0})});
  const std::vector<StampedPose> path{{0.1, turn}, {0.3 + 1e-7, SE3d()}};
  const std::vector<StampedPose> found = continued(path, odometry);
  // Nothing is known before the first pose.
  ASSERT_EQ(found.size(), 4U);
  EXPECT_EQ(found[0].stamp, 0.1);
  EXPECT_TRUE(found[0].pose->is_approx(turn, 1e-12));
  EXPECT_TRUE(found[1].pose->is_approx(turn * SE3d(SO3d(), {1.0, 0.0, 0.0}), 1e-12));
  EXPECT_TRUE(found[2].pose->is_approx(SE3d(), 1e-12));
  EXPECT_TRUE(found[3].pose->is_approx(SE3d(SO3d(), {1.0, 0.0, 0.0}), 1e-12));
  EXPECT_EQ(continued(path, {}).size(), 2U);
}

TEST(FiducialsPeer, SettingsNameThem) {
  const auto read = [](const std::string& text) {
    return read_fiducials_settings(TomlDocument::parse(text, "fiducials.toml").root());
  };
  const FiducialsStudySettings settings = read("[peers]\nisam2 = 'python3 isam2.py'\nb = 'true'\n");
  ASSERT_EQ(settings.peers.size(), 2U);
  EXPECT_EQ(settings.peers[0].name, "isam2");
  EXPECT_EQ(settings.peers[0].command, "python3 isam2.py");
  const std::string taken = testing::thrown_message([&] { read("[peers]\nbest = 'true'\n"); });
  EXPECT_NE(taken.find("peers.best"), std::string::npos) << taken;
}

#ifdef POSEMIX_WITH_YAML

/// Writes the reference as the path, and the heaviest components as the sightings.
constexpr const char* kPerfectCamera = R"(
mkdir "$2" && cp "$(dirname "$0")/tagslam/a/reference_rig.tum" "$2/camera.tum"
awk -F, 'NR == 1 { print "stamp_s,camera,id,tx_m,ty_m,tz_m,qx,qy,qz,qw"; next }
  !($6 in best) || $7 > best[$6] {
    best[$6] = $7
    row[$6] = $1 "," $2 "," $4 "," $8 "," $9 "," $10 "," $11 "," $12 "," $13 "," $14
  }
  END { for (sighting in row) print row[sighting] }' "$1/observations.csv" > "$2/sightings.csv"
)";

TEST(FiducialsPeer, IsScoredInTheSameTables) {
  const testing::TemporaryFolder data;
  testing::write_recording(data, "a", true, 3);
  const std::string script = data.put("perfect.sh", kPerfectCamera).string();
  const Study study = make_fiducials_study({.data = data.path(),
                                            .inputs = {FiducialInput::best},
                                            .peers = {{"perfect", "sh '" + script + "'"}}});
  ASSERT_EQ(study.items, 2U);
  const OrderedJson filter = OrderedJson::parse(study.run_item(0));
  const OrderedJson peer = OrderedJson::parse(study.run_item(1));
  const OrderedJson& row = peer["row"];
  EXPECT_EQ(row["input"], "perfect");
  EXPECT_EQ(row["frames"], testing::kTagFrames);
  EXPECT_EQ(row["frames_not_finite"], 0);
  EXPECT_LT(row["camera_max_m"], 1e-9);
  EXPECT_LT(row["survey_frame_max_m"], 1e-9);
  EXPECT_EQ(row["odometry_rms_m"], filter["row"]["odometry_rms_m"]);
  EXPECT_EQ(row["scored_sightings"], 5 * testing::kTagFrames);
  EXPECT_EQ(row["wrong_share"], row["detector_wrong_share"]);
  EXPECT_EQ(row["detector_wrong_share"], filter["row"]["detector_wrong_share"]);
  EXPECT_TRUE(row["camera_anees"].is_null());
  EXPECT_TRUE(peer["timing"]["times_real_time"].is_null());
  // The same columns, for one table.
  ASSERT_EQ(row.size(), filter["row"].size());
  EXPECT_TRUE(std::equal(row.items().begin(), row.items().end(), filter["row"].items().begin(),
                         [](const auto& a, const auto& b) { return a.key() == b.key(); }));
}

#endif

}  // namespace
}  // namespace posemix
