// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "io/expect_invalid.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/io/dataset.hpp"
#include "posemix/io/dataset_sequence.hpp"
#include "posemix/testing/expect.hpp"
#include "small_dataset.hpp"

namespace posemix {
namespace {

using testing::kSmallFrames;
using testing::MatVariable;
using testing::replaced;
using testing::SmallDataset;

class Dataset : public ::testing::Test {
 protected:
  void expect_small(const DatasetScene& scene) const {
    ASSERT_EQ(scene.images.size(), kSmallFrames);
    ASSERT_EQ(scene.cameras.size(), kSmallFrames);
    for (std::size_t k = 0; k < kSmallFrames; ++k) {
      const auto image = static_cast<std::int64_t>(k + 1);
      const SE3d& camera = small_.recording.camera[k];
      ASSERT_TRUE(scene.cameras.at(image));
      EXPECT_LT((scene.cameras.at(image)->inverse() * camera).log().norm(), 1e-9);
      ASSERT_EQ(scene.images.at(image).size(), 3U);
      for (std::size_t i = 0; i < 3; ++i) {
        const DatasetInstance& instance = scene.images.at(image)[i];
        EXPECT_EQ(instance.object, testing::kSmallObjects[i]);
        const SE3d truth = camera.inverse() * small_.recording.objects[i];
        EXPECT_LT((instance.camera_object.inverse() * truth).log().norm(), 1e-9);
      }
    }
  }

  SlamJob job(const std::string& text) const {
    return read_slam_job(TomlDocument::parse(text, "s.toml"), {small_.folder.path()});
  }

  /// One object of the scene, with `more` keys at the end.
  std::string toml(const std::string& place, const std::string& more = "") const {
    return fmt::format(
        "schema = 1\n[camera]\nground_truth = {{{0}}}\n[[objects]]\nid = \"can\"\n"
        "detections = {{bop = \"results.csv\", scene = 2, object = 5}}\n"
        "ground_truth = {{{0}, object = 5{1}}}\n",
        place, more);
  }

  SmallDataset small_;
};

constexpr const char* kBopPlace = "bop_dataset = \"bop\", scene = 2";
constexpr const char* kYcbPlace = "ycb_video = \"ycb\", sequence = \"0002\"";

TEST_F(Dataset, BopSceneInMetres) {
  expect_small(read_bop_scene(small_.folder / "bop", "test", 2));
}

TEST_F(Dataset, YcbVideoSequenceWithAndWithoutCompression) {
  expect_small(read_ycb_video_scene(small_.folder / "ycb", "0002"));
}

TEST_F(Dataset, YcbVideoFrameOfOneObjectHasAFlatArray) {
  std::vector<MatVariable> meta = testing::meta_of(small_.recording, 0);
  meta[1] = {"cls_indexes", {1, 1}, {5}};
  meta[4].dims = {3, 4};
  meta[4].numbers.resize(12);
  meta.pop_back();
  testing::write_mat(small_.folder / "one/data/0000/000001-meta.mat", meta);
  const DatasetScene scene = read_ycb_video_scene(small_.folder / "one", "0000");
  EXPECT_EQ(scene.images.at(1).at(0).object, 5);
  EXPECT_FALSE(scene.cameras.at(1));
  EXPECT_INVALID_WITH(scene.camera_poses(), "the dataset does not say how the camera moved");
}

TEST_F(Dataset, CameraOfABopSceneMayBeUnknown) {
  const auto cameras = parse_bop_scene_camera("{\"3\": {\"cam_K\": [1]}}", "c.json");
  EXPECT_FALSE(cameras.at(3));
  EXPECT_INVALID_WITH(parse_bop_scene_camera("{\"3\": {\"cam_t_w2c\": [0, 0, 0]}}", "c.json"),
                      "c.json: 3: got no key 'cam_R_w2c', expected one");
}

TEST_F(Dataset, BothFeedSlamWithTheSameTruth) {
  const SlamJob bop = job(toml(kBopPlace));
  const SlamJob ycb = job(toml(kYcbPlace));
  for (const SlamJob* each : {&bop, &ycb}) {
    const Sequence& sequence = each->sequence;
    ASSERT_EQ(sequence.stamps.size(), kSmallFrames);
    EXPECT_DOUBLE_EQ(sequence.stamps[1] - sequence.stamps[0], kFramePeriodS);
    for (std::size_t k = 0; k < kSmallFrames; ++k) {
      const SE3d& camera = small_.recording.camera[k];
      EXPECT_LT((sequence.camera_truth[k]->inverse() * camera).log().norm(), 1e-9);
      const SE3d truth = camera.inverse() * small_.recording.objects[1];
      EXPECT_LT((sequence.objects[0].relative_truth[k]->inverse() * truth).log().norm(), 1e-9);
      EXPECT_TRUE(sequence.objects[0].detections[k]);
    }
    EXPECT_LT((each->camera_prior.mean().inverse() * small_.recording.camera[0]).log().norm(),
              1e-9);
  }
}

TEST_F(Dataset, LeverArmIsOnTheRightOfTheCamerasTruth) {
  const SlamJob moved =
      job(replaced(toml(kBopPlace), "[camera]\n", "[camera]\nlever_arm_m = [0.1, 0, 0]\n"));
  const SE3d arm(SO3d(), {0.1, 0.0, 0.0});
  EXPECT_LT(
      (moved.sequence.camera_truth[3]->inverse() * small_.recording.camera[3] * arm).log().norm(),
      1e-9);
}

TEST_F(Dataset, InstancesOfOneObject) {
  std::string truth = testing::BopTexts(small_.recording).truth;
  for (std::size_t at; (at = truth.find("\"obj_id\": 4")) != std::string::npos;)
    truth.replace(at, 11, "\"obj_id\": 5");
  small_.folder.put("bop/test/000002/scene_gt.json", truth);
  EXPECT_INVALID_WITH(job(toml(kBopPlace)),
                      "image 1: got 2 instances of object 5, expected one, or a key 'instance' (0 "
                      "to 1)");
  const SlamJob second = job(toml(kBopPlace, ", instance = 1"));
  const SE3d expected = small_.recording.camera[0].inverse() * small_.recording.objects[1];
  EXPECT_LT((second.sequence.objects[0].relative_truth[0]->inverse() * expected).log().norm(),
            1e-9);
  EXPECT_INVALID_WITH(job(toml(kBopPlace, ", instance = 2")), "expected more for instance 2");
  small_.folder.put("bop/test/000002/scene_gt.json",
                    replaced(truth, "\"obj_id\": 5", "\"obj_id\": 6"));
  EXPECT_INVALID_WITH(job(toml(kBopPlace, ", instance = 0")), "as in other images");
}

TEST_F(Dataset, ErrorsNameFileAndKey) {
  const std::string gt =
      "{\"1\": [{\"obj_id\": 5, \"cam_R_m2c\": [1, 0, 0, 0, 1, 0, 0, 0, 1], "
      "\"cam_t_m2c\": [0, 0, 500]}]}";
  const auto parse = [&](std::string_view old, std::string_view by) {
    return testing::invalid_input_message(
        [&] { parse_bop_scene_gt(replaced(gt, old, by), "gt.json"); });
  };
  EXPECT_EQ(parse("\"1\"", "\"one\""), "gt.json: got the key \"one\", expected an image id");
  EXPECT_EQ(parse("[0, 0, 500]", "[0, 0]"), "gt.json: 1[0]: cam_t_m2c: got 2 entries, expected 3");
  EXPECT_NE(parse("[1, 0", "[2, 0").find("gt.json: 1[0]: cam_R_m2c: "), std::string::npos);
  EXPECT_NE(parse(": 5", ": 5.5").find("expected an object id"), std::string::npos);
  EXPECT_NE(parse("500", "1e15").find("gt.json: 1[0]: cam_t_m2c: got a position"),
            std::string::npos);
  EXPECT_INVALID_WITH(parse_bop_scene_gt("{", "gt.json"), "gt.json: got a text that is not JSON");
  EXPECT_INVALID_WITH(read_bop_scene(small_.folder / "bop", "test", 7), "000007: is not there");
  EXPECT_INVALID_WITH(job(toml("bop_dataset = \"bop\", scene = 2, split = \"../test\"")),
                      "'camera.ground_truth.split'");
  EXPECT_INVALID_WITH(job(toml("bop_dataset = \"bop\", scene = 2, first_frame = 4")),
                      "first_frame' is 4, but ");
  EXPECT_INVALID_WITH(job(toml(kBopPlace) + "[[objects]]\nid = \"x\"\nclass = \"y\"\n"),
                      "no table [[candidates]] has that class");
}

TEST_F(Dataset, ErrorsNameTheVariableOfAMatlabFile) {
  const auto error = [&](const std::vector<MatVariable>& meta) {
    const auto path = small_.folder / "bad/data/0000/000001-meta.mat";
    testing::write_mat(path, meta);
    return testing::invalid_input_message(
        [&] { read_ycb_video_scene(small_.folder / "bad", "0000"); });
  };
  const std::vector<MatVariable> good = testing::meta_of(small_.recording, 0);
  std::vector<MatVariable> meta = good;
  meta.erase(meta.begin() + 1);
  EXPECT_NE(error(meta).find("000001-meta.mat: variable 'cls_indexes': got none"),
            std::string::npos);
  meta = good;
  meta[1].numbers[0] = 4.5;
  EXPECT_NE(error(meta).find("'cls_indexes': got 4.5"), std::string::npos);
  meta = good;
  meta[1] = {"cls_indexes", {2, 1}, {4, 5}};
  EXPECT_NE(error(meta).find("'poses': got 3x4x3, expected 3x4x2"), std::string::npos);
  meta = good;
  meta[4].numbers[0] = 7.0;
  EXPECT_NE(error(meta).find("variable 'poses': matrix 1: "), std::string::npos) << error(meta);
  meta = good;
  meta[4].numbers[0] = NAN;
  EXPECT_NE(error(meta).find("expected finite ones"), std::string::npos);
  meta = good;
  meta[5].dims = {4, 3};
  EXPECT_NE(error(meta).find("'rotation_translation_matrix': got 4x3, expected 3x4"),
            std::string::npos);
  small_.folder.put("bad/data/0000/000001-meta.mat", "text");
  EXPECT_INVALID_WITH(read_ycb_video_scene(small_.folder / "bad", "0000"),
                      "got no MATLAB file of version 5");
}

class DatasetSequenceFile : public Dataset {
 protected:
  DatasetSequence request(const std::string& dataset) const {
    DatasetSequence request;
    request.dataset = small_.folder / dataset;
    request.scene = 2;
    request.results = small_.folder / "results.csv";
    return request;
  }
  SlamJob job_of(const DatasetSequence& request) const {
    return job(format_dataset_sequence(request).toml);
  }
};

TEST_F(DatasetSequenceFile, OfBothDatasetsIsReadBySlam) {
  for (const char* dataset : {"bop", "ycb"}) {
    const SlamJob slam = job_of(request(dataset));
    ASSERT_EQ(slam.models.size(), 3U) << dataset;
    EXPECT_EQ(slam.sequence.camera_truth.size(), kSmallFrames);
    for (const ObjectRecording& object : slam.sequence.objects) {
      EXPECT_EQ(object.relative_truth.size(), kSmallFrames);
      EXPECT_TRUE(object.detections[0]);
    }
  }
  small_.folder.put("ycb/image_sets/classes.txt",
                    "a\nb\nc\n005_tomato_soup_can\n006_mustard_bottle\n");
  EXPECT_EQ(job_of(request("ycb")).models[0].id, "005_tomato_soup_can");
  EXPECT_EQ(job_of(request("ycb")).models[2].id, "14");
}

TEST_F(DatasetSequenceFile, DeclaresSymmetriesAndObjectsThatAreWanted) {
  small_.folder.put("bop/models/models_info.json",
                    "{\"5\": {\"diameter\": 100, \"symmetries_continuous\": [{\"axis\": [0, 0, 1], "
                    "\"offset\": [0, 0, 0]}]}}");
  DatasetSequence wanted = request("bop");
  wanted.objects = {5};
  wanted.lever_arm_m = Eigen::Vector3d(0.02, 0.0, 0.001);
  wanted.frame_period_s = 0.05;
  const SlamJob slam = job_of(wanted);
  ASSERT_EQ(slam.models.size(), 1U);
  EXPECT_FALSE(slam.models[0].symmetries.is_trivial());
  EXPECT_DOUBLE_EQ(slam.sequence.stamps[1] - slam.sequence.stamps[0], 0.05);
  wanted.objects = {77};
  EXPECT_INVALID_WITH(format_dataset_sequence(wanted), "got no estimate of the wanted objects");
}

TEST_F(DatasetSequenceFile, SeveralInstancesShareTheirDetectionsAsCandidates) {
  const auto relabel = [](std::string text, const std::string& old, const std::string& by) {
    for (std::size_t at; (at = text.find(old)) != std::string::npos;)
      text.replace(at, old.size(), by);
    return text;
  };
  small_.folder.put(
      "bop/test/000002/scene_gt.json",
      relabel(testing::BopTexts(small_.recording).truth, "\"obj_id\": 4", "\"obj_id\": 5"));
  small_.folder.put("results.csv",
                    relabel(testing::bop_results(small_.recording), ",4,0.9", ",5,0.9"));
  const DatasetSequenceText text = format_dataset_sequence(request("bop"));
  SlamJob slam = job(text.toml);
  ASSERT_EQ(slam.models.size(), 3U) << text.toml;
  EXPECT_EQ(slam.models[0].id, "5_1");
  EXPECT_EQ(slam.models[1].class_id, "5");
  ASSERT_EQ(slam.sequence.candidates.size(), kSmallFrames);
  EXPECT_EQ(slam.sequence.candidates[0].size(), 2U);
  const SlamRun result = run(slam);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& pose = result.frames.back().objects[i];
    EXPECT_TRUE(pose) << "instance " << i << " is tracked";
  }
  const std::string gaussian_sum = text.toml + "[filter]\nmethod = \"gm-iekf\"\n";
  EXPECT_INVALID_WITH(job(gaussian_sum), "no other filter tells the instances of a class apart");
  EXPECT_INVALID_WITH(
      job(replaced(text.toml, "id = \"5_1\"\n",
                   "id = \"5_1\"\nsymmetries = {discrete = [{rotation_deg = [0, 0, 180]}]}\n")),
      "objects '5_1' and '5_2' are of class '5', but their symmetries differ");
  EXPECT_INVALID_WITH(
      job(replaced(text.toml, "id = \"5_1\"\n",
                   "id = \"5_1\"\nground_truth = {world_pose = [0,0,0,0,0,0,1]}\n")),
      "stands beside 'class'");
}

TEST_F(DatasetSequenceFile, TellsWhatItLeavesOut) {
  std::string truth = testing::BopTexts(small_.recording).truth;
  for (std::size_t at; (at = truth.find("\"obj_id\": 14")) != std::string::npos;)
    truth.replace(at, 12, "\"obj_id\": 15");
  small_.folder.put("bop/test/000002/scene_gt.json", truth);
  const DatasetSequenceText text = format_dataset_sequence(request("bop"));
  ASSERT_EQ(text.notes.size(), 3U);
  EXPECT_EQ(text.notes[0], "object 15 is left out: the results have no estimate of it");
  EXPECT_EQ(text.notes[1],
            "object 14 is left out: it has estimates, but the scene does not have it");
  EXPECT_EQ(text.notes[2],
            "no symmetries are declared: the dataset's models_info.json is not there");
}

}  // namespace
}  // namespace posemix
