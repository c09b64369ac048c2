// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace posemix::fuzzing {

/// Random inputs: those of a corpus with a few bytes changed, removed, repeated or taken from
/// another one, and random bytes. With one compiler the same seed makes the same inputs.
class Mutations {
 public:
  Mutations(std::vector<std::string> corpus, std::uint64_t seed)
      : corpus_(std::move(corpus)), random_(seed) {}

  std::string next() {
    std::string bytes = below(4) == 0 || corpus_.empty() ? noise(60 + below(400)) : any();
    for (std::size_t k = 1 + below(6); k > 0; --k) change(bytes);
    if (bytes.size() > kLongest) bytes.resize(kLongest);
    return bytes;
  }
  /// What was taken may be changed further.
  void keep(std::string bytes) {
    if (below(200) == 0 && corpus_.size() < kMostKept) corpus_.push_back(std::move(bytes));
  }

 private:
  static constexpr std::size_t kLongest = 4096;
  static constexpr std::size_t kMostKept = 20'000;

  std::size_t below(std::size_t n) { return static_cast<std::size_t>(random_() % n); }
  std::size_t place(const std::string& bytes) { return below(bytes.size() + 1); }
  const std::string& any() { return corpus_[below(corpus_.size())]; }
  std::string noise(std::size_t size) {
    std::string bytes(size, '\0');
    for (char& c : bytes) c = static_cast<char>(random_());
    return bytes;
  }
  /// Some of it, from anywhere on.
  std::string part(const std::string& bytes, std::size_t most) {
    return bytes.substr(place(bytes), 1 + below(most));
  }
  void change(std::string& bytes) {
    switch (below(6)) {
      case 0:
        bytes.insert(place(bytes), std::string(1 + below(8), static_cast<char>(random_())));
        return;
      case 1:
        bytes.erase(place(bytes), 1 + below(6));
        return;
      case 2:
        if (!corpus_.empty()) bytes.insert(place(bytes), part(any(), 60));
        return;
      case 3:
        bytes.insert(place(bytes), part(bytes, 40));
        return;
      case 4:
        if (!bytes.empty()) bytes[below(bytes.size())] ^= static_cast<char>(1U << below(8));
        return;
      default:
        bytes.replace(place(bytes), 1 + below(8), noise(1 + below(8)));
    }
  }

  std::vector<std::string> corpus_;
  std::mt19937_64 random_;
};

}  // namespace posemix::fuzzing
