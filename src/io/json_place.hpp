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

/// Largest accepted deviation of a quaternion's norm from one in JSON files.
inline constexpr double kJsonNormTolerance = 1e-6;

/// Parses a document; `expected` says of what.
/// @throws InvalidInput `name: got ..., expected ...` for a text that is not JSON, and for a key
/// that occurs twice in one object
Json parse_json(std::string_view text, const std::string& name, std::string_view expected);

/// A value of a document and the path to it, for messages `file: key: key[0]: got ..., expected
/// ...`.
class JsonPlace {
 public:
  JsonPlace(const Json& json, std::string path) : json_(&json), path_(std::move(path)) {}

  [[noreturn]] void fail(std::string_view got, std::string_view expected) const;
  /// Throws `path: message`, for a message that is a sentence of its own.
  [[noreturn]] void refuse(std::string_view message) const;

  /// The value of a key, which must exist.
  JsonPlace member(std::string_view key) const;
  bool has(std::string_view key) const;
  bool is_null() const { return json_->is_null(); }
  /// The keys of an object, in the order of the text.
  std::vector<std::string> keys() const;
  /// Throws InvalidInput if the object has other keys.
  void require_only(std::initializer_list<std::string_view> keys) const;
  std::vector<JsonPlace> items(std::optional<std::size_t> size = {}) const;

  double number() const;  ///< must be finite
  std::string string() const;
  void require_word(std::string_view expected) const;
  /// An array of `size` finite numbers.
  Eigen::VectorXd vector(std::size_t size) const;
  /// A square matrix as an array of rows.
  Eigen::MatrixXd square_matrix(std::size_t size) const;
  /// A rotation from an array x y z w of norm one within kJsonNormTolerance. An array written from
  /// a rotation is kept bit by bit.
  SO3d rotation() const;

 private:
  const Json* json_;
  std::string path_;
};

}  // namespace posemix::internal
