// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <vector>

#include <posemix/reduction/merge.hpp>

using Peak = posemix::ConcentratedGaussian<posemix::SE3d>;

int main() {
  const Peak::Covariance covariance = 1e-4 * Peak::Covariance::Identity();
  const auto offset = posemix::SE3d::exp((Peak::Tangent() << 0, 0, 0.5, 0, 0, 0).finished());
  const std::vector<posemix::Component<Peak>> peaks{
      {std::log(0.5), Peak(offset, covariance)},
      {std::log(0.5), Peak(offset.inverse(), covariance)}};
  const Peak merged = posemix::merge<posemix::SE3d>(peaks).component.density;
  const bool between = merged.mean().is_approx(posemix::SE3d(), 1e-12);
  return between && merged.covariance()(2, 2) > 0.25 ? 0 : 1;
}
