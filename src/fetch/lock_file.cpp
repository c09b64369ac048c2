// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "lock_file.hpp"

#include <array>
#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/json_fault.hpp"
#include "paths.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"
#include "sources.hpp"

namespace posemix {
namespace {

using LockJson = nlohmann::ordered_json;

constexpr std::int64_t kLockSchema = 1;
constexpr std::string_view kLockType = "posemix.data-lock";
constexpr std::array kChecks{HashCheck::pinned, HashCheck::published, HashCheck::none};

/// A value of a lock file with its place.
class LockValue {
 public:
  LockValue(const LockJson& json, std::string place) : json_(json), place_(std::move(place)) {}

  [[noreturn]] void fail(std::string_view expected) const {
    throw InvalidInput(fmt::format("{}: got {}, expected {}", place_,
                                   in_quotes(json_.dump(-1, ' ', true), 60), expected));
  }
  LockValue member(const std::string& key) const {
    if (!json_.is_object()) fail("an object");
    const auto found = json_.find(key);
    if (found == json_.end())
      throw InvalidInput(fmt::format("{}: got no key '{}', expected one", place_, key));
    return {*found, place_ + ": " + key};
  }
  std::string string() const {
    if (!json_.is_string()) fail("a string");
    return json_.get<std::string>();
  }
  std::uint64_t count() const {
    if (!json_.is_number_unsigned()) fail("a number of bytes");
    return json_.get<std::uint64_t>();
  }
  const LockJson& object() const {
    if (!json_.is_object()) fail("an object");
    return json_;
  }

 private:
  const LockJson& json_;
  std::string place_;
};

HashCheck read_check(const LockValue& value) {
  const std::string word = value.string();
  for (const HashCheck check : kChecks) {
    if (word_of(check) == word) return check;
  }
  value.fail("pinned, published or none");
}

LockEntry read_entry(const LockValue& value) {
  LockEntry entry;
  entry.url = value.member("url").string();
  entry.size = value.member("size").count();
  const LockValue hash = value.member("sha256");
  entry.sha256 = hash.string();
  if (!is_sha256(entry.sha256)) hash.fail("64 hexadecimal digits in lower case");
  entry.check = read_check(value.member("check"));
  entry.date = value.member("date").string();
  return entry;
}

}  // namespace

std::string_view word_of(HashCheck check) {
  switch (check) {
    case HashCheck::pinned:
      return "pinned";
    case HashCheck::published:
      return "published";
    case HashCheck::none:
      break;
  }
  return "none";
}

LockFile parse_lock_file(std::string_view text, const std::string& name) {
  const LockJson json = internal::json_of(text, name, "a lock file");
  const LockValue root(json, name);
  if (root.member("schema").count() != kLockSchema) root.member("schema").fail("1");
  if (root.member("type").string() != kLockType) root.member("type").fail(kLockType);
  LockFile lock{root.member("source").string(), root.member("revision").string(), {}};
  const LockValue files = root.member("files");
  for (const auto& [path, entry] : files.object().items()) {
    if (!is_inner_path(path))
      throw InvalidInput(fmt::format("{}: files: got the path {}, expected one below the folder",
                                     name, in_quotes(path, 200)));
    lock.files[path] = read_entry(LockValue(entry, fmt::format("{}: files: {}", name, path)));
  }
  return lock;
}

std::string format_lock_file(const LockFile& lock) {
  LockJson files = LockJson::object();
  for (const auto& [path, entry] : lock.files) {
    files[path] = {{"url", entry.url},
                   {"size", entry.size},
                   {"sha256", entry.sha256},
                   {"check", word_of(entry.check)},
                   {"date", entry.date}};
  }
  const LockJson json{{"schema", kLockSchema},
                      {"type", kLockType},
                      {"source", lock.source},
                      {"revision", lock.revision},
                      {"files", std::move(files)}};
  return json.dump(1, ' ', false, LockJson::error_handler_t::replace) + "\n";
}

LockFile read_lock_file(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / kLockFileName;
  if (!std::filesystem::exists(path)) return {};
  return parse_lock_file(read_file(path), path.string());
}

std::string download_time() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

}  // namespace posemix
