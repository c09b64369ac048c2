// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "posemix/io/rigid.hpp"
#include "posemix/lie/lie.hpp"

/// NumPy .npy files: arrays, and files that hold one homogeneous 4x4 matrix each.
namespace posemix {

/// An array of any shape; the last index runs fastest.
struct NpyArray {
  std::vector<std::size_t> shape;
  std::vector<double> values;
};

/// The array in the bytes of a .npy file of format version 1, 2 or 3: little-endian 32- or 64-bit
/// floats, C or Fortran order. Throws InvalidInput `name: got ..., expected ...`, also when bytes
/// are missing or left over. The values are not checked.
NpyArray parse_npy_array(std::string_view bytes, const std::string& name);

/// The bytes of a .npy file, format version 1, 64-bit floats in C order.
std::string format_npy(const NpyArray& array);

/// The matrix in the bytes of a .npy file of format version 1, 2 or 3: shape (4, 4), little-endian
/// 32- or 64-bit floats, C or Fortran order. Throws InvalidInput `name: got ..., expected ...`,
/// also when bytes are missing or left over. The entries are not checked.
Eigen::Matrix4d parse_npy_matrix(std::string_view bytes, const std::string& name);

/// The pose in the bytes of a .npy file; its rotation is the nearest rotation to the stored one.
/// Throws InvalidInput as parse_npy_matrix and pose_from_matrix do.
SE3d parse_npy_pose(std::string_view bytes, const std::string& name,
                    double tolerance = kRotationTolerance);

/// As parse_npy_pose, for a file.
SE3d read_npy_pose(const std::filesystem::path& path, double tolerance = kRotationTolerance);

/// The detections T_camera_object (metres) of one object by frame number, counted from one.
///
/// Reads every file `<prefix><number>.npy` of the folder, as `obj_000014_000223.npy` for the prefix
/// `obj_000014_` and frame 223; other files are ignored. Throws InvalidInput with the path for a
/// folder that cannot be read or holds no such file, for a file whose name has no whole positive
/// number between the prefix and `.npy`, for two files of one frame, and for contents that are not
/// a pose.
std::map<std::int64_t, SE3d> read_npy_detections(const std::filesystem::path& folder,
                                                 const std::string& prefix,
                                                 double tolerance = kRotationTolerance);

}  // namespace posemix
