// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "grasp/box_probability.hpp"
#include "posemix/grasp/success_probability.hpp"

namespace posemix::internal {

/// Limits [tan(rotation / 2); translation], infinite for a rotation of pi.
/// @throws InvalidInput for sides out of range
Vector6d checked_limits(const ToleranceBox& box);

/// How a component is covered that is too wide for one chart.
enum class Cover {
  whole,  ///< half of the points are drawn from the component itself
  smooth  ///< no such points, so that the estimate is a smooth function of the grasp
};

/// The probability of boxes of one shape under a mixture.
///
/// A component is moved to a gnomonic chart by its Jacobian at the mode, and Genz's points are
/// drawn from that Gaussian within the box, whose density among these points is g. The chart is
/// that at the centre of the box, where it is nearly linear over all that box and component have in
/// common, otherwise of those at the centre and at the half turns from it that the box reaches the
/// one nearest to the mode. A component that is too wide for that one too has Genz's points for a
/// half and its own draws, of density h, for the other: all count with p / q, q = (g + h) / 2 \cite
/// hesterberg1995weighted, which is bounded, as h is p or near to it, and g is the control variate,
/// since its integral is known \cite owen2000safe. Draws beyond an angle of pi, which wrap around,
/// count where they arrive.
template <class D>
class BoxIntegral {
 public:
  BoxIntegral(const Mixture<D>& mixture, const ToleranceBox& box);

  /// With one randomisation of the points.
  double operator()(const SE3d& m, std::size_t points, RandomStream& stream, Cover cover) const;

  /// What one draw from every component of which there are draws is worth: a probability that the
  /// draws of one randomisation may not have seen.
  double one_draw(const SE3d& m, std::size_t points) const;

 private:
  using Projected = ProjectedGaussian<SE3d>;
  struct Part {
    double weight;
    const D* density;
    Projected projected;  ///< at first order
    typename D::Evaluator evaluator;
    Matrix6d factor;  ///< L of the covariance
    double spread;    ///< largest standard deviation of the rotation [rad]
  };
  /// A Gaussian in the coordinates of a chart at a pose.
  struct Proposal {
    SE3d chart;
    BoxedGaussian gaussian;
  };

  /// The axis of the chart's half turn from the centre of the box, or none, and whether the chart
  /// is nearly linear over what box and component have in common, or they have nothing in common.
  struct Choice {
    std::optional<Eigen::Index> half_turn;
    bool linear;
  };

  Choice choose(const Part& part, const SE3d& m) const;
  Proposal proposal(const Part& part, const SE3d& m, std::optional<Eigen::Index> axis) const;
  double within_chart(const Part& part, const Proposal& proposal, std::size_t points,
                      RandomStream& stream) const;
  double everywhere(const Part& part, const Proposal& proposal, const SE3d& m, std::size_t points,
                    RandomStream& stream) const;
  bool inside(const SE3d& in_box) const;

  Vector6d limit_;
  double reach_;  ///< largest angle of the box [rad]
  std::vector<Part> parts_;
};

extern template class BoxIntegral<ConcentratedGaussian<SE3d>>;
extern template class BoxIntegral<ProjectedGaussian<SE3d>>;

}  // namespace posemix::internal
