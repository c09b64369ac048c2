// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "expect_invalid.hpp"
#include "posemix/io/bop_views.hpp"
#include "posemix/io/dataset.hpp"

namespace posemix {
namespace {

/// The last of the two would be taken in silence.
TEST(BopDataset, RefusesAKeyThatOccursTwiceAndAnImageUnderTwoKeys) {
  const std::string entry =
      R"([{"obj_id": 1, "cam_R_m2c": [1, 0, 0, 0, 1, 0, 0, 0, 1], "cam_t_m2c": [0, 0, 9]}])";
  EXPECT_INVALID(
      parse_bop_scene_gt("{\"3\": " + entry + ", \"4\": [], \"3\": " + entry + "}", "gt.json"),
      "gt.json: got the key \"3\" twice in one object, expected once");
  EXPECT_INVALID(parse_bop_scene_gt("{\"03\": [], \"3\": " + entry + "}", "gt.json"),
                 "gt.json: got image 3 again, expected every image once");
  EXPECT_INVALID(parse_bop_scene_camera(R"({"3": {}, "3": {}})", "camera.json"),
                 "camera.json: got the key \"3\" twice in one object, expected once");
  EXPECT_INVALID(
      parse_image_groups(R"([{"scene_id": 1, "im_id": [3], "scene_id": 2}])", "targets.json"),
      "targets.json: got the key \"scene_id\" twice in one object, expected once");
}

}  // namespace
}  // namespace posemix
