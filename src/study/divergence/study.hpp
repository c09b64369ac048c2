// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <string>
#include <vector>

#include "posemix/base/units.hpp"
#include "posemix/config/toml_table.hpp"
#include "posemix/divergence/estimate.hpp"
#include "posemix/reduction/merge.hpp"
#include "study/engine/study.hpp"

/// The loss of each merge rule on a mixture on SO(3) (midway-merge paper, section V, Fig. 3).
namespace posemix {

/// Two components whose means are the angle phi times `direction` apart (eq. 23), as a rotation
/// vector: the paper's direction (1, -1, 1) makes the angle between them sqrt(3) phi.
struct DivergenceStudySettings {
  std::vector<double> phi_deg{5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 55, 60};
  std::array<double, 2> weights{0.5, 0.5};
  Eigen::Vector3d direction{1, -1, 1};
  Eigen::Vector3d first_sd_rad = Eigen::Vector3d::Constant(radians(5.0));
  Eigen::Vector3d second_sd_rad = Eigen::Vector3d::Constant(radians(10.0));
  double relative_tolerance = 1e-8;  ///< tolerance of the quadrature
  /// Step of the paper's own integration on a grid (eq. 28), which is computed as well if
  /// this is positive; the paper has 0.3.
  double paper_grid_step_deg = 0.0;
};

/// One row of the study.
struct DivergenceRow {
  std::string rule;
  DivergenceEstimate kl;   ///< D(mixture || merged) [nats]
  DivergenceEstimate isd;  ///< integral square distance [rad^-3]
};

/// The mixture of eq. 23 at one angle.
std::vector<Component<ConcentratedGaussian<SO3d>>> divergence_components(
    const DivergenceStudySettings& settings, double phi_deg);

/// The divergences of each rule at one angle: midway, tangent_of_larger with the first
/// (tangent_of_larger_anchor_1) and with the second component as the anchor, and moment_matched.
std::vector<DivergenceRow> merge_divergences(const DivergenceStudySettings& settings,
                                             double phi_deg);

/// Reads settings; keys as in docs/studies.md, defaults as above.
/// @throws InvalidInput naming file, line and key
DivergenceStudySettings read_divergence_settings(const TomlTable& table);

/// The study: one work item per angle. Rows: `phi_deg`, `rule`, `kl`, `isd`, their estimated
/// errors.
Study make_divergence_study(const DivergenceStudySettings& settings);

}  // namespace posemix
