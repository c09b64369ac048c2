// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "posemix/io/bop_views.hpp"
#include "posemix/slam/fuse_views.hpp"

/// The input of `posemix fuse-views`.
namespace posemix {

struct FuseViewsInput {
  std::string results;
  std::optional<std::string> dataset;
  std::string split = "test";
  std::optional<std::string> cameras;
  std::optional<std::string> ground_truth;
  std::size_t group_size = 0;  ///< zero: by `targets`
  std::optional<std::string> targets;
  std::optional<std::string> models_info;
  bool no_symmetries = false;
  std::optional<std::string> noise;
  BopObservationSettings rows = {};
};

/// The images of a group as views, and what is known of the classes.
struct ViewGroup {
  ImageGroup images;
  std::vector<View> views;
};

struct FuseViewsJob {
  std::vector<ViewGroup> groups;
  ViewClasses classes;
};

/// @throws InvalidInput naming the file, and for an image without a camera pose
FuseViewsJob read_fuse_views_job(const FuseViewsInput& input);

}  // namespace posemix
