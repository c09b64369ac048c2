// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study.hpp"

#include <utility>

#include <nlohmann/json.hpp>

#include "posemix/base/error.hpp"
#include "posemix/divergence/paper_grid.hpp"
#include "posemix/divergence/so3_quadrature.hpp"
#include "report.hpp"
#include "study/engine/settings_json.hpp"

namespace posemix {
namespace {

using Rotation = ConcentratedGaussian<SO3d>;
using Parts = std::vector<Component<Rotation>>;

Rotation merged(const Parts& parts, MergeRule rule) {
  return merge<SO3d>(std::span<const Component<Rotation>>(parts), {.rule = rule}).component.density;
}

/// The merge in the tangent space of the component at `anchor`, whichever is larger.
Rotation merged_at(const Parts& parts, std::size_t anchor) {
  return back_project(tangent_moments<SO3d>(std::span<const Component<Rotation>>(parts),
                                            parts[anchor].density.mean()));
}

std::vector<std::pair<std::string, Rotation>> all_merges(const Parts& parts) {
  return {{"midway", merged(parts, MergeRule::midway)},
          {"tangent_of_larger_anchor_1", merged_at(parts, 0)},
          {"tangent_of_larger_anchor_2", merged_at(parts, 1)},
          {"moment_matched", merged(parts, MergeRule::moment_matched)}};
}

std::string item_text(const DivergenceStudySettings& settings, double phi_deg) {
  nlohmann::ordered_json item{{"rows", nlohmann::ordered_json::array()},
                              {"grid", nlohmann::ordered_json::array()}};
  for (const DivergenceRow& row : merge_divergences(settings, phi_deg)) {
    item["rows"].push_back({{"rule", row.rule},
                            {"kl", row.kl.value},
                            {"kl_error", row.kl.error},
                            {"isd", row.isd.value},
                            {"isd_error", row.isd.error}});
  }
  if (settings.paper_grid_step_deg > 0.0) {
    const Parts parts = divergence_components(settings, phi_deg);
    for (const auto& [rule, density] : all_merges(parts)) {
      const PaperGridDivergence grid = paper_grid_divergence(Mixture<Rotation>(parts), density,
                                                             radians(settings.paper_grid_step_deg));
      item["grid"].push_back(
          {{"rule", rule}, {"kl", grid.kl}, {"isd", grid.isd}, {"mass", grid.mass}});
    }
  }
  return item.dump();
}

std::string settings_json(const DivergenceStudySettings& settings) {
  const nlohmann::ordered_json json{
      {"phi_deg", settings.phi_deg},
      {"weights", settings.weights},
      {"direction", matrix_json(settings.direction.transpose())},
      {"first_sd_rad", matrix_json(settings.first_sd_rad.transpose())},
      {"second_sd_rad", matrix_json(settings.second_sd_rad.transpose())},
      {"relative_tolerance", settings.relative_tolerance},
      {"paper_grid_step_deg", settings.paper_grid_step_deg}};
  return json.dump();
}

}  // namespace

std::vector<Component<Rotation>> divergence_components(const DivergenceStudySettings& settings,
                                                       double phi_deg) {
  const auto covariance = [](const Eigen::Vector3d& sd) {
    return Eigen::Matrix3d(sd.cwiseAbs2().asDiagonal());
  };
  const SO3d second = SO3d::exp(radians(phi_deg) * settings.direction);
  return {{std::log(settings.weights[0]), {SO3d(), covariance(settings.first_sd_rad)}},
          {std::log(settings.weights[1]), {second, covariance(settings.second_sd_rad)}}};
}

std::vector<DivergenceRow> merge_divergences(const DivergenceStudySettings& settings,
                                             double phi_deg) {
  const Parts parts = divergence_components(settings, phi_deg);
  const Mixture<Rotation> mixture(parts);
  const RotationQuadratureSettings quadrature{.relative_tolerance = settings.relative_tolerance};
  std::vector<DivergenceRow> rows;
  for (const auto& [rule, density] : all_merges(parts)) {
    rows.push_back(
        {rule, kl(mixture, density, quadrature), isd(mixture, density, quadrature)});  // eq. 25
  }
  return rows;
}

Study make_divergence_study(const DivergenceStudySettings& settings) {
  require(!settings.phi_deg.empty(), "divergence: there is no angle");
  return {"divergence", settings_json(settings), settings.phi_deg.size(),
          [settings](std::size_t item) { return item_text(settings, settings.phi_deg[item]); },
          [settings](std::span<const std::string> results) {
            return report_divergence(settings, results);
          }};
}

}  // namespace posemix
