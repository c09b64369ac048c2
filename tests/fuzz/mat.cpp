// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "invariants.hpp"
#include "io/temporary_folder.hpp"
#include "posemix/io/dataset.hpp"
#include "target.hpp"

/// MATLAB files of YCB-Video's annotations.
namespace posemix::fuzzing {

POSEMIX_FUZZ_TARGET(mat) {
  static const posemix::testing::TemporaryFolder folder;
  const auto file = folder.put("data/0000/000001-meta.mat", bytes);
  takes(folder.path().string(), [&] {
    const DatasetScene scene = read_ycb_video_scene(folder.path(), "0000");
    for (const DatasetInstance& instance : scene.images.at(1)) expect_pose(instance.camera_object);
    if (scene.cameras.at(1)) expect_pose(*scene.cameras.at(1));
  });
}

}  // namespace posemix::fuzzing
