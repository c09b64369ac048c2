// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <yaml-cpp/yaml.h>
#include <Eigen/Core>

namespace posemix::internal {

/// A value of a YAML document that knows its place. Every member throws InvalidInput
/// `name:line: key: got ..., expected ...`.
class YamlValue {
 public:
  YamlValue(const YamlValue&) = default;
  YamlValue(YamlValue&&) = default;
  /// An assignment of yaml-cpp's nodes would change the document.
  YamlValue& operator=(const YamlValue&) = delete;
  YamlValue& operator=(YamlValue&&) = delete;
  ~YamlValue() = default;

  /// The whole document.
  static YamlValue document(std::string_view text, const std::string& name);

  /// The value of a key of this map.
  YamlValue at(const std::string& key) const;
  std::optional<YamlValue> find(const std::string& key) const;
  /// Keys and values of this map, in the order of the file.
  std::vector<std::pair<std::string, YamlValue>> entries() const;
  /// The elements of this list; none for an empty value.
  std::vector<YamlValue> elements() const;

  double number() const;
  std::int64_t integer() const;
  bool boolean() const;
  std::string text() const;
  /// The numbers of this list, `count` of them unless it is zero.
  std::vector<double> numbers(std::size_t count = 0) const;
  /// The numbers of the keys x, y, z.
  Eigen::Vector3d xyz() const;

  [[noreturn]] void fail(std::string_view got, std::string_view expected) const;
  /// Throws `name:line: key: message`, for a message that is a sentence of its own.
  [[noreturn]] void refuse(std::string_view message) const;

 private:
  YamlValue(const YAML::Node& node, std::string name, std::string key)
      : node_(node), name_(std::move(name)), key_(std::move(key)) {}

  YamlValue child(const YAML::Node& node, const std::string& key) const;
  /// The scalar's text, for messages and conversions.
  std::string scalar(std::string_view expected) const;

  YAML::Node node_;
  std::string name_;  ///< of the file
  std::string key_;   ///< path of keys from the top
};

}  // namespace posemix::internal
