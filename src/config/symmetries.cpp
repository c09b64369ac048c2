// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/config/symmetries.hpp"

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"
#include "posemix/io/bop_models.hpp"
#include "posemix/io/text.hpp"
#include "sequence_parts.hpp"

namespace posemix {
namespace {

using namespace internal;

constexpr std::int64_t kSymmetrySchema = 1;

SymmetryGroups read_groups(const TomlDocument& document) {
  const TomlTable root = document.root();
  const std::int64_t schema = root.get_integer("schema");
  if (schema != kSymmetrySchema)
    root.fail("schema", fmt::format("is {}, expected {}", schema, kSymmetrySchema));
  SymmetryGroups groups;
  const TomlTable objects = root.get_table("symmetries");
  for (const std::string& key : objects.keys()) {
    const auto id = parse_integer(key);
    if (!id || *id < 0) objects.fail(key, "is no object id, expected a number");
    groups.emplace(*id, read_symmetry_group(objects.get_table(key)));
  }
  document.finish();
  return groups;
}

}  // namespace

SymmetryGroup read_symmetry_group(const TomlTable& table) {
  constexpr NumberRange kTurnDeg{.lowest = -360, .highest = 360};
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(3);
  std::vector<SE3d> elements;
  for (const TomlTable& element : table.find_tables("discrete")) {
    const Eigen::Vector3d rotation = element.get_vector_or("rotation_deg", zero, kTurnDeg);
    const Eigen::Vector3d translation = element.get_vector_or("translation_m", zero, kPosition);
    elements.emplace_back(SO3d::exp(kRadPerDeg * rotation), translation);
  }
  std::vector<SymmetryAxis> axes;
  for (const TomlTable& axis : table.find_tables("axes")) {
    const Eigen::Vector3d direction = axis.get_vector("direction", 3, kPosition);
    const Eigen::Vector3d point = axis.get_vector_or("point_m", zero, kPosition);
    axes.push_back({direction, point});
  }
  return located(table, axes.empty() ? "discrete" : "axes",
                 [&] { return SymmetryGroup(elements, axes); });
}

SymmetryGroup internal::read_object_symmetries(const TomlTable& object, const FileFinder& files) {
  const auto table = object.find_table("symmetries");
  if (!table) return {};
  if (!table->has("bop_models_info")) return read_symmetry_group(*table);
  for (const char* other : {"discrete", "axes"}) {
    if (table->has(other)) table->fail(other, "stands beside 'bop_models_info', expected one");
  }
  const std::filesystem::path path = files.find(*table, "bop_models_info");
  const std::int64_t id = table->get_integer("object", kAtLeastZero);
  return read_bop_model(path, id).symmetries;
}

SymmetryGroups parse_symmetry_file(std::string_view text, const std::string& name) {
  return read_groups(TomlDocument::parse(text, name));
}

SymmetryGroups read_symmetry_file(const std::filesystem::path& path) {
  if (path.extension() != ".json") return read_groups(TomlDocument::load(path));
  SymmetryGroups groups;
  for (auto& [id, model] : read_bop_models(path)) groups.emplace(id, std::move(model.symmetries));
  return groups;
}

}  // namespace posemix
