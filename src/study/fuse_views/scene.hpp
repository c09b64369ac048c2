// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "posemix/base/random.hpp"
#include "posemix/io/bop.hpp"

/// Scenes of datasets with estimates and true poses of single images.
namespace posemix {

struct MultiViewScene {
  std::string dataset;  ///< "tless", "ycbv"
  std::int64_t number = 0;
  std::vector<std::int64_t> images;                         ///< with a camera pose, increasing
  std::vector<SE3d> world_camera;                           ///< by image
  std::vector<std::vector<BopRow>> truth;                   ///< by image
  std::vector<std::vector<BopRow>> estimates;               ///< by image
  std::map<std::int64_t, std::vector<SE3d>> world_objects;  ///< true instances by object
};

/// The scenes of a dataset in a data folder: estimates bop_toolkit/*megapose_DATASET*.csv; the
/// truth of T-LESS is bop_toolkit/gt-*tless*.csv, that of YCB-V in the tables
/// consensus-driven-uncertainty/ycbv_*.csv: the objects that at least one of their estimators
/// found.
/// @throws InvalidInput when files are missing
std::vector<MultiViewScene> read_multi_view_scenes(const std::filesystem::path& data,
                                                   const std::string& dataset);

/// Indices of images in groups of `views`; a last group may be smaller, but has at least two.
/// Without a stream in the order of the images.
std::vector<std::vector<std::size_t>> image_groups(std::size_t images, std::size_t views,
                                                   RandomStream* stream);

}  // namespace posemix
