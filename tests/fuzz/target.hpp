// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/base/error.hpp"

/// What the programs of tests/fuzz have in common (docs/fuzzing.md). A target feeds bytes to
/// one part of the library. It returns where they were taken or refused as they should be, and
/// throws otherwise. libFuzzer chooses the bytes (engine.cpp); an ordinary test replays those of
/// the corpus (replay.cpp).
namespace posemix::fuzzing {

using Feed = void (*)(std::string_view bytes);

struct Target {
  std::string name;
  Feed feed;
};

/// The targets that are linked into the program.
inline std::vector<Target>& targets() {
  static std::vector<Target> all;
  return all;
}

struct Registration {
  Registration(const char* name, Feed feed) { targets().push_back({name, feed}); }
};

/// Something that holds for all input did not.
class Broken : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

inline void expect(bool holds, const std::string& what) {
  if (!holds) throw Broken(what);
}

/// Calls `read`, which may refuse its input with InvalidInput that begins with the name of the
/// file, and with no other exception. Returns whether it took it.
template <class Read>
bool takes(std::string_view name, const Read& read) {
  try {
    read();
  } catch (const InvalidInput& refusal) {
    const std::string_view message = refusal.what();
    expect(message.starts_with(name) && message.size() > name.size() + 2,
           "a refusal that does not say which file and why: " + std::string(message));
    return false;
  }
  return true;
}

/// The first byte and the rest, for targets of several readers.
struct Choice {
  explicit Choice(std::string_view bytes)
      : letter(bytes.empty() ? '\0' : bytes.front()), rest(bytes.substr(bytes.empty() ? 0 : 1)) {}
  char letter;
  std::string_view rest;
};

}  // namespace posemix::fuzzing

/// Defines a target: POSEMIX_FUZZ_TARGET(npy) { ... bytes ... }
#define POSEMIX_FUZZ_TARGET(name)                                                        \
  static void feed_##name(std::string_view bytes);                                       \
  static const ::posemix::fuzzing::Registration kRegistered_##name(#name, &feed_##name); \
  static void feed_##name(std::string_view bytes)
