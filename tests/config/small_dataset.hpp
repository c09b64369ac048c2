// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <matio.h>

#include "config/small_bop.hpp"

/// The small recording in the layout of public datasets: scene 2 with objects 4, 5 and 14.
namespace posemix::testing {

/// A variable of a MATLAB file; numbers column by column.
struct MatVariable {
  std::string name;
  std::vector<std::size_t> dims;
  std::vector<double> numbers;
};

inline void write_mat(const std::filesystem::path& path, const std::vector<MatVariable>& variables,
                      bool compressed = true) {
  std::filesystem::create_directories(path.parent_path());
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  if (file == nullptr) throw std::runtime_error("cannot write " + path.string());
  for (MatVariable variable : variables) {  // matio takes no constants
    matvar_t* entry = Mat_VarCreate(variable.name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE,
                                    static_cast<int>(variable.dims.size()), variable.dims.data(),
                                    variable.numbers.data(), 0);
    Mat_VarWrite(file, entry, compressed ? MAT_COMPRESSION_ZLIB : MAT_COMPRESSION_NONE);
    Mat_VarFree(entry);
  }
  Mat_Close(file);
}

/// The twelve numbers of a 3x4 matrix, column by column.
inline std::vector<double> columns_of(const SE3d& pose) {
  const Eigen::Matrix<double, 3, 4> matrix = pose.matrix().topRows<3>();
  return {matrix.data(), matrix.data() + 12};
}

/// The variables of a frame's -meta.mat.
inline std::vector<MatVariable> meta_of(const SmallRecording& recording, std::size_t frame) {
  const SE3d camera_world = recording.camera[frame].inverse();
  MatVariable poses{"poses", {3, 4, recording.objects.size()}, {}};
  for (const SE3d& object : recording.objects) {
    const std::vector<double> columns = columns_of(camera_world * object);
    poses.numbers.insert(poses.numbers.end(), columns.begin(), columns.end());
  }
  return {{"center", {1, 2}, {320, 240}},
          {"cls_indexes", {3, 1}, {4, 5, 14}},
          {"factor_depth", {1, 1}, {10000}},
          {"intrinsic_matrix", {3, 3}, {1066, 0, 0, 0, 1067, 0, 312, 241, 1}},
          poses,
          {"rotation_translation_matrix", {3, 4}, columns_of(camera_world)}};
}

/// Both datasets and the results in a folder of their own.
class SmallDataset {
 public:
  SmallDataset() {
    const BopTexts texts(recording);
    folder.put("bop/test/000002/scene_gt.json", texts.truth);
    folder.put("bop/test/000002/scene_camera.json", texts.camera);
    folder.put("results.csv", bop_results(recording));
    for (std::size_t k = 0; k < kSmallFrames; ++k) {
      write_mat(folder / fmt::format("ycb/data/0002/{:06}-meta.mat", k + 1), meta_of(recording, k),
                k % 2 == 0);
    }
  }

  std::string path(const std::string& name) const { return (folder / name).string(); }

  SmallRecording recording;
  TemporaryFolder folder;
};

}  // namespace posemix::testing
