// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include "posemix/config/toml_table.hpp"
#include "target.hpp"

/// TOML documents, read by getters of every type. What follows a byte 1 is set over the document,
/// as by `--set`.
namespace posemix::fuzzing {
namespace {

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
  }
}

}  // namespace

POSEMIX_FUZZ_TARGET(toml) {
  const std::size_t end = bytes.find('\1');
  const std::string_view assignment = end == bytes.npos ? "" : bytes.substr(end + 1);
  takes("", [&] {
    TomlDocument document = TomlDocument::parse(bytes.substr(0, end), "f");
    if (!assignment.empty()) document.apply_override(std::string(assignment));
    read_every_way(document.root());
    document.finish();
  });
}

}  // namespace posemix::fuzzing
