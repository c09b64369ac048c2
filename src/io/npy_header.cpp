// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "npy_header.hpp"

#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix::internal {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";

[[noreturn]] void fail(const std::string& name, std::string_view got, std::string_view expected) {
  throw InvalidInput(fmt::format("{}: got {}, expected {}", name, got, expected));
}

/// Reads the dictionary literal of a header, whose values are strings, words and tuples.
class DictionaryReader {
 public:
  DictionaryReader(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  std::map<std::string_view, std::string_view> read() {
    std::map<std::string_view, std::string_view> entries;
    expect('{');
    while (!accept('}')) {
      const std::string_view key = string();
      expect(':');
      if (!entries.emplace(key, value()).second)
        stop(fmt::format("the key {} again", in_quotes(key)));
      if (!accept(',') && peek() != '}') stop("no ',' after a value");
    }
    skip_blanks();
    if (position_ != text_.size()) stop("characters after '}'");
    return entries;
  }

 private:
  [[noreturn]] void stop(std::string_view got) const {
    fail(name_, fmt::format("{} in the header {}", got, in_quotes(text_, 100)),
         "{'descr': '<f4', 'fortran_order': False, 'shape': (4, 4), }");
  }
  void skip_blanks() {
    while (position_ < text_.size() && (text_[position_] == ' ' || text_[position_] == '\n')) {
      ++position_;
    }
  }
  char peek() {
    skip_blanks();
    if (position_ == text_.size()) stop("an early end");
    return text_[position_];
  }
  bool accept(char c) {
    if (peek() != c) return false;
    ++position_;
    return true;
  }
  void expect(char c) {
    if (!accept(c)) stop(fmt::format("no '{}'", c));
  }
  std::string_view until(std::size_t begin, std::size_t end, std::string_view what) {
    if (end == std::string_view::npos) stop(fmt::format("no end of a {}", what));
    position_ = end;
    return text_.substr(begin, end - begin);
  }
  std::string_view string() {
    const char quote = peek();
    if (quote != '\'' && quote != '"') stop("no string");
    const std::size_t begin = position_ + 1;
    const std::string_view content = until(begin, text_.find(quote, begin), "string");
    ++position_;
    return content;
  }
  std::string_view value() {
    const char first = peek();
    if (first == '\'' || first == '"') return string();
    if (first != '(') return until(position_, text_.find_first_of(",} \n", position_), "value");
    const std::string_view tuple = until(position_, text_.find(')', position_), "tuple");
    ++position_;
    return tuple;
  }

  std::string_view text_;
  const std::string& name_;
  std::size_t position_ = 0;
};

/// The lengths in a text such as "(4, 4" or "(4,".
std::vector<std::size_t> parse_shape(std::string_view text, const std::string& name) {
  std::vector<std::size_t> shape;
  std::vector<std::string_view> words = split_fields(text.substr(text.empty() ? 0 : 1), ',');
  if (trimmed(words.back()).empty()) words.pop_back();
  for (const std::string_view word : words) {
    const auto length = parse_integer(trimmed(word));
    if (!text.starts_with('(') || !length || *length < 0) {
      fail(name, fmt::format("the shape {}", in_quotes(fmt::format("{})", text))),
           "integers that are not negative");
    }
    shape.push_back(static_cast<std::size_t>(*length));
  }
  return shape;
}

/// The number of bytes before the dictionary, and in it.
struct Extent {
  std::size_t begin, size;
};

Extent dictionary_extent(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with(kMagic)) {
    fail(name, in_quotes(bytes.substr(0, kMagic.size())),
         "a NumPy file, which starts with \"\\x93NUMPY\"");
  }
  const auto byte = [&](std::size_t i) -> std::size_t {
    if (i >= bytes.size())
      fail(name, fmt::format("{} bytes", bytes.size()), "a whole NumPy header");
    return static_cast<unsigned char>(bytes[i]);
  };
  const std::size_t major = byte(6);
  if (major < 1 || major > 3 || byte(7) != 0) {
    fail(name, fmt::format("NumPy format {}.{}", major, byte(7)), "1.0, 2.0 or 3.0");
  }
  Extent extent{major == 1 ? 10U : 12U, byte(8) | byte(9) << 8};
  if (major > 1) extent.size |= byte(10) << 16 | byte(11) << 24;
  if (extent.size > bytes.size() - extent.begin) {
    fail(name, fmt::format("{} bytes", bytes.size()),
         fmt::format("at least the {} bytes of the header", extent.begin + extent.size));
  }
  return extent;
}

}  // namespace

NpyHeader parse_npy_header(std::string_view bytes, const std::string& name) {
  const Extent extent = dictionary_extent(bytes, name);
  auto entries = DictionaryReader(bytes.substr(extent.begin, extent.size), name).read();
  for (const std::string_view key : {"descr", "fortran_order", "shape"}) {
    if (!entries.contains(key))
      fail(name, fmt::format("a header without '{}'", key), "one with it");
  }
  if (entries.size() != 3)
    fail(name, "unknown keys in the header", "descr, fortran_order and shape");
  const std::string_view type = entries["descr"];
  if (type != "<f4" && type != "<f8") {
    fail(name, fmt::format("numbers of type {}", in_quotes(type)),
         "'<f4' or '<f8' (little-endian floats)");
  }
  const std::string_view order = entries["fortran_order"];
  if (order != "True" && order != "False") {
    fail(name, fmt::format("fortran_order {}", in_quotes(order)), "True or False");
  }
  return {extent.begin + extent.size, type == "<f4" ? 4U : 8U, order == "True",
          fmt::format("{})", entries["shape"]), parse_shape(entries["shape"], name)};
}

std::string format_npy_header(const std::vector<std::size_t>& shape) {
  constexpr std::size_t kBeforeText = 10;
  constexpr std::size_t kHeaderAlignment = 64;
  std::string text = fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}{}), }}",
                                 fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
  text.append(kHeaderAlignment - 1 - (kBeforeText + text.size()) % kHeaderAlignment, ' ');
  text += '\n';
  const auto low = static_cast<char>(text.size() & 0xff);
  const auto high = static_cast<char>(text.size() >> 8);
  return std::string(kMagic) + '\x01' + '\0' + low + high + text;
}

}  // namespace posemix::internal
