// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/text.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "base/uninterrupted.hpp"
#include "input_files.hpp"
#include "posemix/base/error.hpp"

namespace posemix {
namespace {

constexpr std::size_t kLargestFile = std::size_t{1} << 30;
constexpr std::string_view kBlanks = " \t";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

[[noreturn]] void fail_to_read(const std::filesystem::path& path, int reason) {
  internal::throw_if_interrupted(reason, path.string());
  throw InvalidInput(fmt::format("{}: cannot be read: {}", path.string(), std::strerror(reason)));
}

using OpenFile = std::unique_ptr<std::FILE, CloseFile>;

OpenFile open_to_read(const std::filesystem::path& path) {
  OpenFile file(std::fopen(path.c_str(), "rb"));
  if (!file) fail_to_read(path, errno);
  return file;
}

std::string read_all(const std::filesystem::path& path, OpenFile file) {
  std::string bytes;
  std::array<char, 65536> buffer;
  while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), file.get())) {
    bytes.append(buffer.data(), got);
    if (bytes.size() > kLargestFile) fail_to_read(path, EFBIG);
  }
  if (std::ferror(file.get())) fail_to_read(path, errno);
  return bytes;
}

/// `word` without a leading '+', unless another sign follows.
std::string_view without_plus(std::string_view word) {
  const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+';
  return plus ? word.substr(1) : word;
}

template <typename Number>
std::optional<Number> parse_whole(std::string_view word) {
  word = without_plus(word);
  Number value{};
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return value;
}

}  // namespace

std::string internal::read_earlier_file(const std::filesystem::path& path) {
  return read_all(path, open_to_read(path));
}

std::string read_file(const std::filesystem::path& path) {
  OpenFile file = open_to_read(path);
  internal::remember_input(file.get());
  return read_all(path, std::move(file));
}

std::string in_quotes(std::string_view text, std::size_t limit) {
  std::string result = "\"";
  for (const char c : text.substr(0, limit)) {
    const bool printable = c >= ' ' && c <= '~';
    if (printable) {
      result += c;
    } else {
      result += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    }
  }
  return result + (text.size() > limit ? "...\"" : "\"");
}

std::optional<double> parse_number(std::string_view word) {
  const std::optional<double> value = parse_whole<double>(word);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::int64_t> parse_integer(std::string_view word) {
  return parse_whole<std::int64_t>(word);
}

std::vector<std::string_view> split_words(std::string_view line) {
  std::vector<std::string_view> words;
  std::size_t begin = line.find_first_not_of(kBlanks);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBlanks, end);
  }
  return words;
}

std::vector<std::string_view> split_fields(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  std::size_t begin = 0;
  for (std::size_t end; (end = line.find(separator, begin)) != std::string_view::npos;
       begin = end + 1) {
    fields.push_back(line.substr(begin, end - begin));
  }
  fields.push_back(line.substr(begin));
  return fields;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

LineReader::LineReader(std::string_view text, std::string name)
    : rest_(text), name_(std::move(name)) {
  if (const std::size_t nul = text.find('\0'); nul != std::string_view::npos) {
    const auto before = text.substr(0, nul);
    number_ = 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
    fail("a NUL byte (binary content)", "text");
  }
  if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
}

bool LineReader::next() {
  if (rest_.empty()) return false;
  const std::size_t end = std::min(rest_.find('\n'), rest_.size());
  line_ = rest_.substr(0, end);
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  if (line_.ends_with('\r')) line_.remove_suffix(1);
  ++number_;
  return true;
}

bool LineReader::next_content() {
  while (next()) {
    const std::string_view content = trimmed(line_);
    if (!content.empty() && content.front() != '#') return true;
  }
  return false;
}

void LineReader::fail(std::string_view got, std::string_view expected) const {
  throw InvalidInput(fmt::format("{}:{}: got {}, expected {}", name_, number_, got, expected));
}

double LineReader::number_from(std::string_view word, std::string_view column) const {
  const std::optional<double> value = parse_number(word);
  if (!value) fail(fmt::format("{} = {}", column, in_quotes(word)), "a finite number");
  return *value;
}

std::int64_t LineReader::index_from(std::string_view word, std::string_view column) const {
  const std::optional<std::int64_t> value = parse_integer(word);
  if (!value || *value < 0) {
    fail(fmt::format("{} = {}", column, in_quotes(word)), "an integer that is not negative");
  }
  return *value;
}

}  // namespace posemix
