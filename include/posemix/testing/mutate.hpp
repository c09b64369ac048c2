// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "posemix/base/error.hpp"
#include "posemix/base/random.hpp"

/// Damaged inputs for fuzz tests of parsers.
namespace posemix::testing {

/// Damages texts and binary contents; the same seed gives the same damage on every machine.
class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : random_(seed) {}

  /// A copy of `text` with one to four damages: bits flipped, bytes deleted, inserted or repeated,
  /// lines swapped, doubled or dropped, a number or a word replaced by an awkward one, the end cut
  /// off.
  std::string operator()(std::string_view text) {
    std::string result(text);
    const std::size_t damages = 1 + below(4);
    for (std::size_t i = 0; i < damages; ++i) damage(result);
    return result;
  }

  /// A uniform integer in [0, bound); zero where the bound is zero.
  std::size_t below(std::size_t bound) {
    return bound == 0 ? 0
                      : static_cast<std::size_t>(random_.uniform() * static_cast<double>(bound));
  }

 private:
  void damage(std::string& text) {
    switch (below(10)) {
      case 0:
        return flip_bit(text);
      case 1:
        return erase(text);
      case 2:
        return insert_bytes(text);
      case 3:
        return repeat(text);
      case 4:
        return swap_lines(text);
      case 5:
        return repeat_line(text);
      case 6:
        return drop_line(text);
      case 7:
        return replace_number(text);
      case 8:
        return insert_token(text);
      default:
        return text.resize(below(text.size() + 1));
    }
  }

  std::size_t short_length() { return 1 + below(8); }

  void flip_bit(std::string& text) {
    if (text.empty()) return;
    char& byte = text[below(text.size())];
    byte = static_cast<char>(static_cast<unsigned char>(byte) ^ (1U << below(8)));
  }

  void erase(std::string& text) { text.erase(below(text.size() + 1), short_length()); }

  void insert_bytes(std::string& text) {
    std::string bytes;
    const std::size_t length = short_length();
    for (std::size_t i = 0; i < length; ++i) bytes += static_cast<char>(below(256));
    text.insert(below(text.size() + 1), bytes);
  }

  void repeat(std::string& text) {
    const std::string piece = text.substr(below(text.size() + 1), 4 * short_length());
    text.insert(below(text.size() + 1), piece);
  }

  /// Begin and size of a line with its end.
  std::pair<std::size_t, std::size_t> some_line(const std::string& text) {
    const std::size_t inside = below(text.size());
    const std::size_t before = inside == 0 ? std::string::npos : text.rfind('\n', inside - 1);
    const std::size_t begin = before == std::string::npos ? 0 : before + 1;
    const std::size_t end = std::min(text.find('\n', inside), text.size());
    return {begin, std::min(end + 1, text.size()) - begin};
  }

  void swap_lines(std::string& text) {
    const auto [begin, size] = some_line(text);
    const std::string line = text.substr(begin, size);
    text.erase(begin, size);
    text.insert(some_line(text).first, line);
  }

  void repeat_line(std::string& text) {
    const auto [begin, size] = some_line(text);
    text.insert(begin, text.substr(begin, size));
  }

  void drop_line(std::string& text) {
    const auto [begin, size] = some_line(text);
    text.erase(begin, size);
  }

  void replace_number(std::string& text) {
    static constexpr std::array<std::string_view, 16> kNumbers{"nan",
                                                               "inf",
                                                               "-inf",
                                                               "1e999",
                                                               "-1e999",
                                                               "1e-999",
                                                               "0",
                                                               "-0",
                                                               "-1",
                                                               "0x10",
                                                               "1e308",
                                                               "99999999999999999999",
                                                               "9223372036854775807",
                                                               "1.0.0",
                                                               "1_0",
                                                               "+-1"};
    constexpr std::string_view kDigits = "+-.0123456789e";
    const std::size_t begin = text.find_first_of("0123456789", below(text.size() + 1));
    if (begin == std::string::npos) return;
    const std::size_t end = std::min(text.find_first_not_of(kDigits, begin), text.size());
    text.replace(begin, end - begin, kNumbers[below(kNumbers.size())]);
  }

  void insert_token(std::string& text) {
    static constexpr std::array<std::string_view, 20> kTokens{"\n",
                                                              "\r\n",
                                                              "\r",
                                                              "\t",
                                                              " ",
                                                              "#",
                                                              ",",
                                                              ".",
                                                              "=",
                                                              "[",
                                                              "]",
                                                              "[[",
                                                              "{",
                                                              "}",
                                                              "\"",
                                                              "'''",
                                                              "${",
                                                              "true",
                                                              "\xEF\xBB\xBF",
                                                              "1979-05-27"};
    text.insert(below(text.size() + 1), kTokens[below(kTokens.size())]);
  }

  RandomStream random_;
};

/// Outcomes of a parser on damaged inputs.
struct FuzzReport {
  std::size_t accepted = 0;           ///< inputs for which it returned
  std::size_t rejected = 0;           ///< inputs for which it threw InvalidInput
  std::vector<std::string> failures;  ///< any other exception, with the input
};

/// Calls `parse` with `count` damaged copies of the originals, in turn. It must return,
/// possibly after checks of the result, or throw InvalidInput; any other exception is reported as a
/// failure.
template <typename Parse>
FuzzReport fuzz(std::span<const std::string> originals, std::size_t count, std::uint64_t seed,
                Parse&& parse) {
  FuzzReport report;
  Mutator mutate(seed);
  for (std::size_t i = 0; i < count; ++i) {
    const std::string input = mutate(originals[i % originals.size()]);
    try {
      parse(input);
      ++report.accepted;
    } catch (const InvalidInput&) {
      ++report.rejected;
    } catch (const std::exception& error) {
      report.failures.push_back(std::string(error.what()) + "\ninput:\n" + input);
    }
  }
  return report;
}

}  // namespace posemix::testing
