// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include "posemix/config/toml_table.hpp"
#include "target.hpp"

/// TOML documents, read by getters of every type. What follows a byte 1 is set over the document,
/// as by `--set`.
namespace posemix::fuzzing {
namespace {

/// What is only looked at, or has a value otherwise, of a key and of one that there is not.
void read_if_there(const TomlTable& table, const std::string& key) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(2);
  const auto attempt = [](const auto& read) { takes("", read); };
  for (const std::string& name : {key, key + "_sd_deg"}) {
    expect(table.has(name) || !(table.is_array(name) || table.is_string(name)),
           "nothing of a type");
    attempt([&] { table.get_double_or(name, 1.0); });
    attempt([&] { table.get_integer_or(name, 1); });
    attempt([&] { table.get_bool_or(name, true); });
    attempt([&] { table.get_string_or(name, "a"); });
    attempt([&] { table.get_strings_or(name, {}); });
    attempt([&] { expect(table.get_vector_or(name, zero).size() == 2, "another size"); });
    attempt([&] { expect(!table.find_table(name) || table.is_table(name), "no table"); });
    attempt([&] { table.find_tables(name); });
    attempt([&] { table.get_double(name); });
  }
}

/// Reads the keys leniently, so that every key reaches every getter.
void read_every_way(const TomlTable& table) {
  enum class Word { one, two };
  // What an override has set is refused in the name of the option.
  const auto attempt = [](const auto& read) { takes("", read); };
  for (const std::string& key : table.keys()) {
    attempt([&] { expect(std::isfinite(table.get_double(key)), "a number that is not finite"); });
    attempt([&] { expect(table.get_double(key, kUnitInterval) <= 1, "a number out of range"); });
    attempt([&] { expect(table.get_integer(key, kAtLeastOne) >= 1, "an integer out of range"); });
    attempt([&] { table.get_bool(key); });
    attempt([&] { table.get_string(key); });
    attempt([&] { table.get_strings(key); });
    attempt([&] { table.get_enum<Word>(key, {{"midway", Word::one}, {"npy", Word::two}}); });
    attempt([&] { expect(table.get_vector(key).allFinite(), "a vector that is not finite"); });
    attempt([&] { expect(table.get_matrix(key, 2, 2).size() == 4, "a matrix of another size"); });
    attempt([&] { read_every_way(table.get_table(key)); });
    attempt([&] {
      for (const TomlTable& item : table.get_tables(key)) read_every_way(item);
    });
    read_if_there(table, key);
    attempt([&] { expect(!table.text_of(key).empty(), "a value without a text"); });
    expect(!table.location(key).empty(), "a value that is nowhere");
  }
}

/// Reads as the reader of a file that knows a few keys alone.
void read_strictly(std::string_view text) {
  TomlDocument document = TomlDocument::parse(text, "f");
  document.set_variable("name", "given");
  document.rename_key("old", "new");
  const TomlTable root = document.root();
  for (const char* key : {"range_m", "turn_deg", "name", "new", "objects"}) root.has(key);
  expect(document.inputs().empty(), "a file that was read");
  for (const std::string& warning : document.warnings())
    expect(warning.starts_with("f:"), "a warning that has no place");
  document.finish();
}

}  // namespace

POSEMIX_FUZZ_TARGET(toml) {
  const std::size_t end = bytes.find('\1');
  const std::string_view assignment = end == bytes.npos ? "" : bytes.substr(end + 1);
  takes("f", [&] { read_strictly(bytes.substr(0, end)); });
  takes("", [&] {
    TomlDocument document = TomlDocument::parse(bytes.substr(0, end), "f");
    if (!assignment.empty()) document.apply_override(std::string(assignment));
    read_every_way(document.root());
    expect(!document.name().empty(), "a document without a name");
    document.finish();
  });
}

}  // namespace posemix::fuzzing
