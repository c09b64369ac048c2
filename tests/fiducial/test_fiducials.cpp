// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "io/expect_invalid.hpp"
#include "io/temporary_folder.hpp"
#include "posemix/fiducial/fiducial_folder.hpp"
#include "posemix/io/observation_csv.hpp"
#include "posemix/io/text.hpp"
#include "views.hpp"

namespace posemix {
namespace {

using testing::image_of;
using testing::kTagSize;
using testing::pinhole_camera;
using testing::view;
using testing::with_noise;

RigCamera camera(const std::string& name, const std::string& topic) {
  return {.name = name, .model = pinhole_camera(), .topics = {topic}};
}

CornerSighting sighting(double stamp, const std::string& topic, std::int64_t tag,
                        const TagCorners& corners) {
  return {.stamp_s = stamp, .topic = topic, .tag = tag, .corners = corners};
}

std::vector<CornerSighting> draw(const std::string& topic, double sd, int count) {
  RandomStream stream(5);
  std::vector<CornerSighting> sightings;
  for (int i = 0; i < count; ++i) {
    const SE3d pose =
        view(0.5 + 3.0 * stream.uniform(), 1.2 * stream.uniform(), 6.0 * stream.uniform());
    sightings.push_back(
        sighting(0.1 * i, topic, i % 3, with_noise(image_of(pose, pinhole_camera()), sd, stream)));
  }
  return sightings;
}

TEST(Fiducials, AreObservationsInTheOrderOfTheSightings) {
  const std::vector<RigCamera> cameras{camera("left", "/l"), camera("right", "/r")};
  TagMap tags;
  tags.default_size_m = kTagSize;
  const SE3d truth = view(0.6, 0.9);
  const TagCorners corners = image_of(truth, pinhole_camera());
  const std::vector<CornerSighting> sightings{sighting(1.0, "/l", 5, corners),
                                              sighting(0.5, "right", 7, corners)};
  const Fiducials found =
      observe_fiducials(sightings, cameras, tags, {.noise = CornerNoise{.sd_px = 0.2}});
  ASSERT_EQ(found.observations.size(), 2U);
  EXPECT_EQ(found.observations[0].object, "5");
  EXPECT_EQ(found.observations[0].camera, "left");
  EXPECT_EQ(found.observations[0].stamp_s, 1.0);
  EXPECT_EQ(found.observations[1].camera, "right");
  EXPECT_TRUE(found.observations[0].components[0].pose.is_approx(truth, 1e-6));
  EXPECT_EQ(found.noise[0].source, CornerNoiseSource::given);
  EXPECT_EQ(ambiguous_count(found.observations), 0U);
}

TEST(Fiducials, EveryCameraHasItsNoise) {
  const std::vector<RigCamera> cameras{camera("a", "/a"), camera("b", "/b"), camera("c", "/c")};
  TagMap tags;
  tags.default_size_m = kTagSize;
  std::vector<CornerSighting> sightings = draw("/a", 0.1, 400);
  for (const CornerSighting& s : draw("/b", 0.5, 400)) sightings.push_back(s);
  for (const CornerSighting& s : draw("/c", 0.5, 10)) sightings.push_back(s);
  const Fiducials found = observe_fiducials(sightings, cameras, tags);
  EXPECT_NEAR(found.noise[0].noise.sd_px, 0.1, 0.02);
  EXPECT_NEAR(found.noise[1].noise.sd_px, 0.5, 0.1);
  EXPECT_EQ(found.noise[1].source, CornerNoiseSource::own);
  EXPECT_EQ(found.noise[2].source, CornerNoiseSource::all);
  const Fiducials few = observe_fiducials(draw("/a", 0.1, 10), cameras, tags);
  EXPECT_EQ(few.noise[0].source, CornerNoiseSource::assumed);
  EXPECT_GT(ambiguous_count(found.observations), 0U);
}

TEST(Fiducials, CountWhatBecomesNoObservation) {
  TagMap tags;
  tags.size_m[1] = kTagSize;
  tags.size_m[2] = kTagSize;
  tags.ignored = {2};
  const TagCorners corners = image_of(view(0.6, 0.9), pinhole_camera());
  const TagCorners clockwise{corners[3], corners[2], corners[1], corners[0]};
  const std::vector<CornerSighting> sightings{
      sighting(0.0, "/a", 1, corners), sighting(0.1, "/a", 2, corners),
      sighting(0.2, "/a", 3, corners), sighting(0.3, "/a", 1, clockwise)};
  const std::vector<RigCamera> cameras{camera("a", "/a")};
  const Fiducials found = observe_fiducials(sightings, cameras, tags);
  EXPECT_EQ(found.sightings, 4U);
  EXPECT_EQ(found.observations.size(), 1U);
  EXPECT_EQ(found.ignored, 1U);
  EXPECT_EQ(found.without_size, 1U);
  EXPECT_EQ(found.without_pose, 1U);
}

/// The only warning of `found`, or all of them.
std::string warning_of(const Fiducials& found) {
  std::string all;
  for (const std::string& warning : found.warnings) all += warning + "\n";
  return all;
}

TEST(Fiducials, WarnOfWhatIsHardlyTrue) {
  const std::vector<RigCamera> cameras{camera("a", "/a")};
  TagMap tags;
  tags.default_size_m = kTagSize;
  const auto contains = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  const std::vector<CornerSighting> good = draw("/a", 0.5, 100);
  EXPECT_EQ(warning_of(observe_fiducials(good, cameras, tags)), "");
  for (const int count : {10, 100}) {
    const std::string noisy = warning_of(observe_fiducials(draw("/a", 40.0, count), cameras, tags));
    EXPECT_TRUE(contains(noisy, "the corners of camera \"a\" are those of a square tag to"))
        << noisy;
  }
  for (const double sd : {119.0, 1e-9}) {
    const std::string stated = warning_of(
        observe_fiducials(good, cameras, tags, {.noise = CornerNoise{.sd_px = sd, .dof = 0.1}}));
    EXPECT_TRUE(contains(stated, "px, expected 0.001 to 3 px")) << stated;
    EXPECT_TRUE(contains(stated, "0.1 degrees of freedom, expected at least 1")) << stated;
  }
  for (const double size : {150.0, 0.00015}) {
    TagMap wrong;
    wrong.default_size_m = size;
    const std::string sizes = warning_of(observe_fiducials(good, cameras, wrong));
    EXPECT_TRUE(contains(sizes, "a tag has an edge of")) << sizes;
  }
  const std::string order =
      warning_of(observe_fiducials(good, cameras, tags, {.order = CornerOrder::aruco}));
  EXPECT_TRUE(contains(order, "the corners of 100 of 100 sightings are no image")) << order;
  std::vector<RigCamera> small = cameras;
  small[0].model.intrinsics = {150.0, 150.0, 160.0, 120.0};
  const std::string resolution = warning_of(observe_fiducials(good, small, tags));
  EXPECT_TRUE(contains(resolution, "lie beyond the image, expected none beyond (480, 360) px"))
      << resolution;
}

TEST(Fiducials, RefuseAnUnknownCamera) {
  const std::vector<RigCamera> cameras{camera("a", "/a")};
  const std::vector<CornerSighting> sightings{
      sighting(0.0, "/z", 1, image_of(view(0.6, 0.9), pinhole_camera()))};
  EXPECT_INVALID(observe_fiducials(sightings, cameras, {}),
                 "sighting 0: got the topic \"/z\", expected that of a camera or its name");
  EXPECT_INVALID_WITH(observe_fiducials(sightings, {}, {}), "there is no camera");
  const std::vector<RigCamera> twins{camera("a", "/a"), camera("b", "/a")};
  EXPECT_INVALID_WITH(observe_fiducials(sightings, twins, {}), "that of cameras a and b");
}

TEST(FiducialFolder, HasTheObservationsAsATable) {
  const testing::TemporaryFolder folder;
  FiducialFolder all;
  all.cameras = {camera("a", "/a")};
  all.cameras[0].rig_camera = StatedPose{SE3d(), Matrix6d(1e-4 * Matrix6d::Identity())};
  all.tags.default_size_m = kTagSize;
  all.tags.priors[1] = StatedPose{SE3d(), Matrix6d(1e-6 * Matrix6d::Identity())};
  all.odometry = {{0.0, SE3d()}, {1.0, SE3d()}};
  all.fiducials = observe_fiducials(draw("/a", 0.3, 60), all.cameras, all.tags);
  write_fiducial_folder(all, folder / "out");
  const auto read = read_observations(folder / "out/observations.csv");
  ASSERT_EQ(read.size(), all.fiducials.observations.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    const Observation& before = all.fiducials.observations[i];
    ASSERT_EQ(read[i].components.size(), before.components.size());
    EXPECT_EQ(read[i].object, before.object);
    EXPECT_EQ(read[i].components[0].weight, before.components[0].weight);
    EXPECT_TRUE(read[i].components[0].pose.is_approx(before.components[0].pose, 1e-10));
  }
  EXPECT_TRUE(read_file(folder / "out/tag_priors.csv").starts_with("id,size_m,tx_m"));
  EXPECT_TRUE(read_file(folder / "out/cameras.csv").starts_with("camera,tx_m"));
  EXPECT_TRUE(read_file(folder / "out/corner_noise.csv").starts_with("camera,sd_px,dof"));
  EXPECT_EQ(read_tum(folder / "out/odometry.tum").size(), 2U);
  all.compress = true;
  write_fiducial_folder(all, folder / "small");
  EXPECT_EQ(format_observations(read_observations(folder / "small/observations.csv.gz")),
            format_observations(read));
}

}  // namespace
}  // namespace posemix
