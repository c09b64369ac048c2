// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "override_option.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/toml_node.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

/// The parts of the key that is set. Empty for a text that sets none: the document refuses it, with
/// the reason.
std::vector<std::string> override_key(const std::string& assignment) {
  try {
    return internal::override_path(assignment);
  } catch (const InvalidInput&) {
    return {};
  }
}

/// Whether the later assignment leaves nothing of the earlier one: it is of the same key, or of a
/// table around it.
bool replaces(const std::vector<std::string>& later, const std::vector<std::string>& earlier) {
  return !later.empty() && later.size() <= earlier.size() &&
         std::equal(later.begin(), later.end(), earlier.begin());
}

void require_all_to_count(const std::vector<std::string>& overrides) {
  std::vector<std::vector<std::string>> keys;
  for (const std::string& later : overrides) {
    const std::vector<std::string> key = override_key(later);
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (!replaces(key, keys[i])) continue;
      throw CLI::ValidationError(
          "--set", fmt::format("{} replaces {}, expected one value for a key", in_quotes(later, 80),
                               in_quotes(overrides[i], 80)));
    }
    keys.push_back(key);
  }
}

}  // namespace

CLI::Option* add_override_option(CLI::App& command, std::vector<std::string>& overrides,
                                 const std::string& help) {
  const auto take = [&overrides](const std::vector<std::string>& given) {
    require_all_to_count(given);
    overrides = given;
  };
  return command.add_option_function<std::vector<std::string>>("--set", take, help)
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

const std::string* find_override(const std::vector<std::string>& overrides,
                                 const std::string& key) {
  const auto found = std::find_if(overrides.begin(), overrides.end(), [&](const std::string& each) {
    return fmt::format("{}", fmt::join(override_key(each), ".")) == key;
  });
  return found == overrides.end() ? nullptr : &*found;
}

}  // namespace posemix
