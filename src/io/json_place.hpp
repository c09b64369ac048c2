// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "json_numbers.hpp"

namespace posemix::internal {

/// Deviation of a quaternion's norm from one that JSON files are allowed.
inline constexpr double kJsonNormTolerance = 1e-6;

/// A value of a document and the path to it, for messages `file: key: key[0]: got ..., expected
/// ...`.
class JsonPlace {
 public:
  JsonPlace(const Json& json, std::string path) : json_(&json), path_(std::move(path)) {}

  [[noreturn]] void fail(std::string_view got, std::string_view expected) const;

  /// The value of a key that must be there.
  JsonPlace member(std::string_view key) const;
  bool has(std::string_view key) const;
  /// The keys of an object, in the order of the text.
  std::vector<std::string> keys() const;
  /// Refuses an object that has other keys.
  void require_only(std::initializer_list<std::string_view> keys) const;
  std::vector<JsonPlace> items(std::optional<std::size_t> size = {}) const;

  double number() const;  ///< finite
  std::string string() const;
  void require_word(std::string_view expected) const;
  /// An array of so many finite numbers.
  Eigen::VectorXd vector(std::size_t size) const;
  /// A square array of rows.
  Eigen::MatrixXd square_matrix(std::size_t size) const;
  /// An array x y z w of norm one within kJsonNormTolerance; kept bit by bit where a rotation
  /// stored it.
  SO3d rotation() const;

 private:
  const Json* json_;
  std::string path_;
};

}  // namespace posemix::internal
