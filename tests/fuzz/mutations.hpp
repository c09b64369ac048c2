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
/// another one, and random bytes. The same seed makes the same inputs.
class Mutations {
 public:
  Mutations(std::vector<std::string> corpus, std::uint64_t seed)
      : corpus_(std::move(corpus)), random_(seed) {}

  std::string next() {
    const bool is_noise = below(4) == 0 || corpus_.empty();
    std::string bytes = is_noise ? noise(60 + below(400)) : any();
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
    const std::size_t from = place(bytes);
    return bytes.substr(from, 1 + below(most));
  }
  // A compiler may evaluate arguments in any order, so every number is drawn by a statement.
  void change(std::string& bytes) {
    const std::size_t kind = below(6);
    const std::size_t at = place(bytes);
    const std::size_t size = 1 + below(8);
    switch (kind) {
      case 0:
        bytes.insert(at, std::string(size, static_cast<char>(random_())));
        return;
      case 1:
        bytes.erase(at, size);
        return;
      case 2:
        if (!corpus_.empty()) bytes.insert(at, part(any(), 60));
        return;
      case 3:
        bytes.insert(at, part(bytes, 40));
        return;
      case 4:
        if (at < bytes.size()) bytes[at] ^= static_cast<char>(1U << (size - 1));
        return;
      default:
        bytes.replace(at, size, noise(1 + below(8)));
    }
  }

  std::vector<std::string> corpus_;
  std::mt19937_64 random_;
};

}  // namespace posemix::fuzzing
