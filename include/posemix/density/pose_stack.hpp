// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>

#include "posemix/density/concentrated_gaussian.hpp"

/// Marginal, conditional and relative poses of a joint density over several poses.
namespace posemix {

/// The joint marginal density of the poses at `indices`, in that order. Exact.
/// @throws InvalidInput when an index is out of range or occurs twice
ConcentratedGaussian<PoseStackd> marginal(const ConcentratedGaussian<PoseStackd>& joint,
                                          std::span<const std::size_t> indices);

/// The marginal density of the pose at `index`. Exact.
/// @throws InvalidInput when the index is out of range
ConcentratedGaussian<SE3d> marginal(const ConcentratedGaussian<PoseStackd>& joint,
                                    std::size_t index);

/// The density of the poses that are not at `indices`, in their order, given that the poses at
/// `indices` have the `values`: the Gaussian conditional in the tangent space, back-projected to
/// zero mean (first order in the correction).
/// @throws InvalidInput when sizes differ, an index is out of range or occurs twice, or no pose is
/// left
ConcentratedGaussian<PoseStackd> conditional(const ConcentratedGaussian<PoseStackd>& joint,
                                             std::span<const std::size_t> indices,
                                             std::span<const SE3d> values);

/// The density of T_from^-1 T_to, including the cross-covariance of the two poses, to first order:
/// the error of the relative pose is Ad(T_from^-1) (xi_to - xi_from), in frame `from`.
/// @throws InvalidInput when an index is out of range or the two are the same
ConcentratedGaussian<SE3d> relative_pose(const ConcentratedGaussian<PoseStackd>& joint,
                                         std::size_t from, std::size_t to);

}  // namespace posemix
