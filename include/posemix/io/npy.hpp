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

/// NumPy .npy files: arrays, and files with one homogeneous 4x4 matrix each.
namespace posemix {

/// An array of any shape; the last index changes fastest.
struct NpyArray {
  std::vector<std::size_t> shape;
  std::vector<double> values;
};

/// The array in the bytes of a .npy file of format version 1, 2 or 3: little-endian 32- or 64-bit
/// floats, C or Fortran order. The values are not checked.
/// @throws InvalidInput `name: got ..., expected ...`, also when bytes are missing or left over
NpyArray parse_npy_array(std::string_view bytes, const std::string& name);

/// The bytes of a .npy file: format version 1, 64-bit floats in C order.
std::string format_npy(const NpyArray& array);

/// The matrix in the bytes of a .npy file of format version 1, 2 or 3: shape (4, 4), little-endian
/// 32- or 64-bit floats, C or Fortran order. The entries are not checked.
/// @throws InvalidInput `name: got ..., expected ...`, also when bytes are missing or left over
Eigen::Matrix4d parse_npy_matrix(std::string_view bytes, const std::string& name);

/// The pose in the bytes of a .npy file; its rotation is the one nearest to the matrix in the file.
/// @throws InvalidInput as parse_npy_matrix and pose_from_matrix
SE3d parse_npy_pose(std::string_view bytes, const std::string& name,
                    double tolerance = kRotationTolerance);

/// Reads a file as parse_npy_pose reads bytes.
SE3d read_npy_pose(const std::filesystem::path& path, double tolerance = kRotationTolerance);

/// Reads the detections T_camera_object [m] of one object by frame number, counted from one.
///
/// Reads every file `<prefix><number>.npy` of the folder, such as `obj_000014_000223.npy` for the
/// prefix `obj_000014_` and frame 223; other files are ignored.
/// @throws InvalidInput with the path for a folder that cannot be read or has no such file, a file
/// whose name has no positive integer between the prefix and `.npy`, two files of one frame, and
/// contents that are not a pose
std::map<std::int64_t, SE3d> read_npy_detections(const std::filesystem::path& folder,
                                                 const std::string& prefix,
                                                 double tolerance = kRotationTolerance);

}  // namespace posemix
