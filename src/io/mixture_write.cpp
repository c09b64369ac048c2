// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "json_numbers.hpp"
#include "mixture_parts.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

using namespace internal;

Json array_of(const Eigen::Ref<const Eigen::VectorXd>& vector) {
  return std::vector<double>(vector.begin(), vector.end());
}

Json xyzw_of(const SO3d& rotation) { return array_of(rotation.quaternion().coeffs()); }

Json rows_of(const Matrix6d& matrix) {
  Json rows = Json::array();
  for (Eigen::Index row = 0; row < 6; ++row) rows.push_back(array_of(matrix.row(row).transpose()));
  return rows;
}

Eigen::Vector3d checked_position(const Eigen::Vector3d& translation) {
  if (!is_position(translation)) {
    throw InvalidInput(
        fmt::format("a position with a coordinate that is not within {:g} m", kFarthestPosition));
  }
  return translation;
}

Json place_json(const ConcentratedGaussian<SE3d>& density, const MixtureConvention& convention) {
  const Eigen::Vector3d translation = checked_position(density.mean().translation());
  const Matrix6d covariance =
      convention.side == Side::left ? density.covariance() : density.body_covariance();
  return {{"mean",
           {{"translation", array_of(translation / metres_per_unit(convention.length))},
            {"quaternion_xyzw", xyzw_of(density.mean().rotation())}}},
          {"covariance", rows_of(stated_covariance(checked_covariance(covariance, 6, "covariance"),
                                                   convention))}};
}

Json place_json(const ProjectedGaussian<SE3d>& density, const MixtureConvention& convention) {
  const Vector6d& mean = density.tangent_mean();
  require(mean.allFinite(), "a mean that is not finite");
  const Eigen::Vector3d translation = checked_position(mean.tail<3>());
  return {
      {"tangent_point", {{"quaternion_xyzw", xyzw_of(density.tangent_point())}}},
      {"tangent_mean",
       {{"u", array_of(mean.head<3>())},
        {"translation", array_of(translation / metres_per_unit(convention.length))}}},
      {"covariance", rows_of(stated_covariance(
                         checked_covariance(density.covariance(), 6, "covariance"), convention))}};
}

template <class D>
Json component_json(const Component<D>& component, const MixtureConvention& convention) {
  Json json;
  if (std::isinf(component.log_weight)) {
    json["weight"] = 0.0;
  } else {
    json["log_weight"] = component.log_weight;
  }
  json.update(place_json(component.density, convention));
  return json;
}

/// The text of the components, one line for each.
template <class D>
std::string components_text(const Mixture<D>& mixture, const MixtureConvention& convention) {
  const auto normalised = Mixture<D>::from_stored(mixture.components());
  std::string text;
  for (std::size_t i = 0; i < normalised.size(); ++i) {
    try {
      text += fmt::format("{}    {}", i == 0 ? "" : ",\n",
                          component_json(normalised[i], convention).dump());
    } catch (const InvalidInput& error) {
      throw InvalidInput(fmt::format("component {} of the mixture: {}", i, error.what()));
    }
  }
  return text;
}

void check_frame(const std::string& name) {
  if (!is_frame_name(name)) {
    throw InvalidInput(fmt::format(
        "frame name: got {}, expected 1 to {} printable ASCII characters without blanks",
        in_quotes(name), kLongestFrameName));
  }
}

}  // namespace

std::string format_mixture(const MixtureFile& file, const MixtureConvention& convention) {
  check_frame(file.frames.from);
  check_frame(file.frames.to);
  const bool projected = std::holds_alternative<ProjectedPoses>(file.mixture);
  MixtureConvention stated = convention;
  if (projected) {
    stated.side = Side::right;
    stated.angle = AngleUnit::rad;
  }
  const Json head = {{"schema", kMixtureSchema},
                     {"type", kMixtureType},
                     {"group", kMixtureGroup},
                     {"distribution", projected ? kProjectedWord : kConcentratedWord},
                     {"side", word_of(stated.side)},
                     {"order", word_of(stated.order)},
                     {"units",
                      {{"rotation", projected ? kProjectedUnit : word_of(stated.angle)},
                       {"translation", word_of(stated.length)}}},
                     {"frames", {{"from", file.frames.from}, {"to", file.frames.to}}}};
  std::string text = "{\n";
  for (const auto& [key, value] : head.items()) {
    text += fmt::format("  \"{}\": {},\n", key, value.dump());
  }
  const std::string components = std::visit(
      [&](const auto& mixture) { return components_text(mixture, stated); }, file.mixture);
  return text + "  \"components\": [\n" + components + "\n  ]\n}\n";
}

}  // namespace posemix
