// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "posemix/draw/chart.hpp"

/// The colours of methods, which are the same in all figures and in the page
/// (report/src/ui/methods.ts; a test compares them).
namespace posemix::internal {

/// A method and the number of its colour among those of objects. Variants of a method have its
/// colour, and a dashed line.
struct MethodLook {
  std::string_view name;
  int colour;
  bool dashed;
};

/// The colour of what is no method, but what methods are compared with.
inline constexpr int kReferenceColour = -1;

inline constexpr std::array<MethodLook, 26> kMethodLooks{{
    {"detector", kReferenceColour, false},
    {"odometry", kReferenceColour, false},
    {"published: ACT", kReferenceColour, true},
    {"default", 2, false},
    {"multi-object", 2, false},
    {"default_smoothed", 2, true},
    {"multi-object, smoothed", 2, true},
    {"riekf", 0, false},
    {"iterated_riekf", 0, true},
    {"midway", 1, false},
    {"gm-iekf", 1, false},
    {"midway_iterated", 4, false},
    {"iterated", 4, false},
    {"tangent_of_larger", 5, false},
    {"iterated_tangent_of_larger", 5, true},
    {"tangent_of_larger_anchor_1", 5, false},
    {"tangent_of_larger_anchor_2", 5, true},
    {"riekf_cauchy", 3, false},
    {"moment_matched", 3, false},
    {"riekf_gated", 7, false},
    {"no_merge_64", 7, false},
    {"max_mixture", 8, false},
    {"largest_with_smallest", 8, false},
    {"rbpf", 6, false},
    {"runnalls_pairs", 6, false},
    {"published", 9, false},
}};

/// An empty series of a method, with its colour and a dot on every point; of a method that is not
/// in the table with the colour of its place in the legend.
ChartSeries method_series(const std::string& method);

}  // namespace posemix::internal
