// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include <fmt/format.h>

#include "json_place.hpp"
#include "mixture_parts.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"
#include "renamed.hpp"

namespace posemix {
namespace {

using namespace internal;

template <Spelled Value>
Value value_of(const JsonPlace& place) {
  const std::string got = place.string();
  for (const auto& [word, value] : words<Value>) {
    if (got == word) return value;
  }
  static_assert(words<Value>.size() == 2);
  place.fail(in_quotes(got), fmt::format("{} or {}", in_quotes(words<Value>[0].first),
                                         in_quotes(words<Value>[1].first)));
}

/// The name of the key "distribution" in the previous release.
constexpr std::string_view kOldDistributionKey = "law";

/// The key "distribution", or its old name if the file has that.
std::string_view distribution_key(const JsonPlace& root) {
  if (!root.has(kOldDistributionKey)) return "distribution";
  if (root.has("distribution")) {
    root.fail("both 'distribution' and 'law', its old name", "'distribution' alone");
  }
  return kOldDistributionKey;
}

void check_schema(const JsonPlace& root) {
  root.member("type").require_word(kMixtureType);
  const JsonPlace schema = root.member("schema");
  const double number = schema.number();
  if (number != static_cast<double>(kMixtureSchema)) {
    schema.fail(
        fmt::format("{}", number),
        fmt::format("{}: the file was written in another version of the format", kMixtureSchema));
  }
  root.require_only({"schema", "type", "group", distribution_key(root), "side", "order", "units",
                     "frames", "components"});
  root.member("group").require_word(kMixtureGroup);
}

bool is_projected(const JsonPlace& distribution) {
  const std::string word = distribution.string();
  if (word != kConcentratedWord && word != kProjectedWord) {
    distribution.fail(in_quotes(word), fmt::format("{} or {}", in_quotes(kConcentratedWord),
                                                   in_quotes(kProjectedWord)));
  }
  return word == kProjectedWord;
}

MixtureConvention read_convention(const JsonPlace& root, bool projected) {
  MixtureConvention convention;
  const JsonPlace units = root.member("units");
  units.require_only({"rotation", "translation"});
  convention.order = value_of<TangentOrder>(root.member("order"));
  convention.length = value_of<LengthUnit>(units.member("translation"));
  convention.side = value_of<Side>(root.member("side"));
  if (projected) {
    root.member("side").require_word(word_of(Side::right));
    units.member("rotation").require_word(kProjectedUnit);
  } else {
    convention.angle = value_of<AngleUnit>(units.member("rotation"));
  }
  return convention;
}

FrameNames read_frames(const JsonPlace& place) {
  place.require_only({"from", "to"});
  const auto name = [&](std::string_view key) {
    const JsonPlace member = place.member(key);
    std::string word = member.string();
    if (!is_frame_name(word)) {
      member.fail(in_quotes(word), fmt::format("1 to {} printable ASCII characters without blanks",
                                               kLongestFrameName));
    }
    return word;
  };
  return {name("from"), name("to")};
}

double read_log_weight(const JsonPlace& place) {
  if (place.has("weight") == place.has("log_weight")) {
    place.fail(place.has("weight") ? "both 'weight' and 'log_weight'" : "no key 'log_weight'",
               "one of 'weight' and 'log_weight'");
  }
  if (place.has("log_weight")) return place.member("log_weight").number();
  const JsonPlace weight = place.member("weight");
  const double number = weight.number();
  if (number < 0.0) weight.fail(fmt::format("{}", number), "a number of at least zero");
  return std::log(number);
}

Eigen::Vector3d read_translation(const JsonPlace& place, LengthUnit unit) {
  Eigen::Vector3d translation = metres_per_unit(unit) * place.vector(3);
  if (!is_position(translation)) {
    place.fail("a position that is too far", fmt::format("at most {:g} m", kFarthestPosition));
  }
  return translation;
}

/// Calls `make` with the covariance at `place`; an InvalidInput that it throws is reported as an
/// error of that covariance.
template <class Make>
auto with_covariance(const JsonPlace& place, const MixtureConvention& convention,
                     const Make& make) {
  const Matrix6d stated = place.square_matrix(6);
  try {
    return make(plain_covariance(checked_covariance(stated, 6, "the matrix"), convention));
  } catch (const InvalidInput& error) {
    place.refuse(fmt::format("{}, expected a symmetric positive definite matrix", error.what()));
  }
}

ConcentratedGaussian<SE3d> read_density(const JsonPlace& place, const MixtureConvention& convention,
                                        const ConcentratedGaussian<SE3d>* /*distribution*/) {
  place.require_only({"weight", "log_weight", "mean", "covariance"});
  const JsonPlace mean = place.member("mean");
  mean.require_only({"translation", "quaternion_xyzw"});
  const SE3d pose(mean.member("quaternion_xyzw").rotation(),
                  read_translation(mean.member("translation"), convention.length));
  return with_covariance(place.member("covariance"), convention, [&](const Matrix6d& p) {
    return ConcentratedGaussian<SE3d>(
        pose, convention.side == Side::left ? p : pose.adjoint_congruence(p));
  });
}

ProjectedGaussian<SE3d> read_density(const JsonPlace& place, const MixtureConvention& convention,
                                     const ProjectedGaussian<SE3d>* /*distribution*/) {
  place.require_only({"weight", "log_weight", "tangent_point", "tangent_mean", "covariance"});
  const JsonPlace point = place.member("tangent_point");
  point.require_only({"quaternion_xyzw"});
  const JsonPlace mean = place.member("tangent_mean");
  mean.require_only({"u", "translation"});
  Vector6d y;
  y.head<3>() = mean.member("u").vector(3);
  y.tail<3>() = read_translation(mean.member("translation"), convention.length);
  const SO3d rotation = point.member("quaternion_xyzw").rotation();
  auto density = with_covariance(place.member("covariance"), convention, [&](const Matrix6d& p) {
    return ProjectedGaussian<SE3d>(rotation, y, p);
  });
  if (!std::isfinite(density.log_normalizer())) {
    place.fail("a density without a finite normaliser", "a mean and covariance of u near one");
  }
  return density;
}

template <class D>
Mixture<D> read_components(const JsonPlace& place, const MixtureConvention& convention) {
  std::vector<Component<D>> components;
  for (const JsonPlace& item : place.items()) {
    const double log_weight = read_log_weight(item);
    components.push_back({log_weight, read_density(item, convention, static_cast<D*>(nullptr))});
  }
  try {
    return Mixture<D>::from_stored(std::move(components));
  } catch (const InvalidInput& error) {
    place.refuse(
        fmt::format("{}, expected at least one component with a weight above zero", error.what()));
  }
}

}  // namespace

MixtureFile parse_mixture(std::string_view text, const std::string& name) {
  const Json json = parse_json(text, name, "a mixture file");
  const JsonPlace root(json, name);
  check_schema(root);
  std::vector<std::string> warnings;
  const std::string_view key = distribution_key(root);
  if (key == kOldDistributionKey) {
    warnings.push_back(renamed_warning(name, "key", key, "distribution"));
  }
  const bool projected = is_projected(root.member(key));
  const MixtureConvention convention = read_convention(root, projected);
  FrameNames frames = read_frames(root.member("frames"));
  const JsonPlace components = root.member("components");
  if (projected) {
    return {std::move(frames), read_components<ProjectedGaussian<SE3d>>(components, convention),
            std::move(warnings)};
  }
  return {std::move(frames), read_components<ConcentratedGaussian<SE3d>>(components, convention),
          std::move(warnings)};
}

MixtureFile read_mixture(const std::filesystem::path& path) {
  return parse_mixture(read_file(path), path.string());
}

}  // namespace posemix
