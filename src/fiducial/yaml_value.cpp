// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "yaml_value.hpp"

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix::internal {
namespace {

std::string_view kind_of(const YAML::Node& node) {
  switch (node.Type()) {
    case YAML::NodeType::Map:
      return "a map";
    case YAML::NodeType::Sequence:
      return "a list";
    case YAML::NodeType::Scalar:
      return "a single value";
    default:
      return "nothing";
  }
}

}  // namespace

YamlValue YamlValue::document(std::string_view text, const std::string& name) {
  try {
    return {YAML::Load(std::string(text)), name, ""};
  } catch (const YAML::Exception& error) {
    throw InvalidInput(fmt::format("{}:{}: got text that is not YAML ({}), expected a document",
                                   name, error.mark.line + 1, error.msg));
  }
}

void YamlValue::fail(std::string_view got, std::string_view expected) const {
  refuse(fmt::format("got {}, expected {}", got, expected));
}

void YamlValue::refuse(std::string_view message) const {
  throw InvalidInput(fmt::format("{}:{}: {}{}", name_, node_.Mark().line + 1,
                                 key_.empty() ? "" : key_ + ": ", message));
}

YamlValue YamlValue::child(const YAML::Node& node, const std::string& key) const {
  return {node, name_, key_.empty() ? key : key_ + "." + key};
}

std::optional<YamlValue> YamlValue::find(const std::string& key) const {
  if (!node_.IsMap()) fail(kind_of(node_), "a map");
  const YAML::Node value = node_[key];
  if (!value.IsDefined() || value.IsNull()) return std::nullopt;
  return child(value, key);
}

YamlValue YamlValue::at(const std::string& key) const {
  const std::optional<YamlValue> value = find(key);
  if (!value) fail("no key " + in_quotes(key), "one of that name");
  return *value;
}

std::vector<std::pair<std::string, YamlValue>> YamlValue::entries() const {
  if (!node_.IsMap()) fail(kind_of(node_), "a map");
  std::vector<std::pair<std::string, YamlValue>> all;
  for (const auto& entry : node_) {
    if (!entry.first.IsScalar()) fail(kind_of(entry.first), "names as keys");
    all.emplace_back(entry.first.Scalar(), child(entry.second, entry.first.Scalar()));
  }
  return all;
}

std::vector<YamlValue> YamlValue::elements() const {
  if (node_.IsNull()) return {};
  if (!node_.IsSequence()) fail(kind_of(node_), "a list");
  std::vector<YamlValue> all;
  all.reserve(node_.size());
  for (std::size_t i = 0; i < node_.size(); ++i)
    all.push_back({node_[i], name_, fmt::format("{}[{}]", key_, i)});
  return all;
}

std::string YamlValue::scalar(std::string_view expected) const {
  if (!node_.IsScalar()) fail(kind_of(node_), expected);
  return node_.Scalar();
}

double YamlValue::number() const {
  const std::string word = scalar("a number");
  const std::optional<double> value = parse_number(word);
  if (!value) fail(in_quotes(word), "a finite number");
  return *value;
}

std::int64_t YamlValue::integer() const {
  const std::string word = scalar("an integer");
  const std::optional<std::int64_t> value = parse_integer(word);
  if (!value) fail(in_quotes(word), "an integer");
  return *value;
}

bool YamlValue::boolean() const {
  const std::string word = scalar("true or false");
  bool value = false;
  if (!YAML::convert<bool>::decode(node_, value)) fail(in_quotes(word), "true or false");
  return value;
}

std::string YamlValue::text() const { return scalar("a text"); }

std::vector<double> YamlValue::numbers(std::size_t count) const {
  std::vector<double> all;
  for (const YamlValue& element : elements()) all.push_back(element.number());
  if (count > 0 && all.size() != count)
    fail(fmt::format("{} numbers", all.size()), fmt::format("{}", count));
  return all;
}

Eigen::Vector3d YamlValue::xyz() const {
  return {at("x").number(), at("y").number(), at("z").number()};
}

}  // namespace posemix::internal
