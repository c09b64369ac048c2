// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "mat_file.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mat_element.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix::internal {
namespace {

constexpr std::size_t kHeader = 128;
/// Of a compressed variable, what is uncompressed for its name: flags, up to 200 dimensions, and a
/// name of up to 63 characters.
constexpr std::size_t kBegin = 1024;

// Classes of variables: below these are cells, structures, objects, texts and sparse matrices.
constexpr std::uint32_t kFirstNumeric = 6;
constexpr std::uint32_t kLastNumeric = 15;
constexpr std::uint32_t kComplex = 0x800;

std::optional<std::vector<std::size_t>> dims_of(const MatElement& element, bool little_endian) {
  if (element.type != MatType::int32) return std::nullopt;
  const auto numbers = element.numbers(little_endian);
  if (!numbers || numbers->empty()) return std::nullopt;
  std::vector<std::size_t> dims;
  for (const double number : *numbers) {
    if (number < 0.0) return std::nullopt;
    dims.push_back(static_cast<std::size_t>(number));
  }
  return dims;
}

}  // namespace

MatFile::MatFile(const std::filesystem::path& path)
    : name_(path.string()), bytes_(read_file(path)) {
  // Version and byte order end the header; MATLAB's files of version 7.3 are HDF5.
  using std::string_view_literals::operator""sv;
  const std::string_view end = std::string_view(bytes_).substr(0, kHeader);
  little_endian_ = end.ends_with("\0\1IM"sv);
  if (end.size() < kHeader || (!little_endian_ && !end.ends_with("\1\0MI"sv))) {
    throw InvalidInput(
        fmt::format("{}: got no MATLAB file of version 5, expected one", path.string()));
  }
  std::string_view rest = std::string_view(bytes_).substr(kHeader);
  while (!rest.empty()) {
    const auto element = take_element(rest, little_endian_);
    if (!element) {
      throw InvalidInput(
          fmt::format("{}: got a file that is cut off, expected a whole MATLAB file", name_));
    }
    if (element->type == MatType::matrix) list(element->data, element->data, false);
    if (element->type != MatType::compressed) continue;
    const auto begin = inflated_prefix(element->data, kBegin);
    if (!begin || begin->bytes.size() < kMatTag) {
      throw InvalidInput(
          fmt::format("{}: got damaged compressed data, expected a MATLAB file", name_));
    }
    list(std::string_view(begin->bytes).substr(kMatTag), element->data, true);
  }
}

void MatFile::list(std::string_view begin, std::string_view content, bool is_compressed) {
  const std::size_t size = begin.size();
  const auto flags = take_element(begin, little_endian_);
  const auto dims = take_element(begin, little_endian_);
  const auto name = take_element(begin, little_endian_);
  if (!flags || !dims || !name || flags->type != MatType::uint32) return;
  const auto words = flags->numbers(little_endian_);
  auto lengths = dims_of(*dims, little_endian_);
  if (!words || words->size() != 2 || !lengths) return;
  const auto word = static_cast<std::uint32_t>((*words)[0]);
  const std::uint32_t kind = word & 0xffU;
  variables_.push_back({.name = std::string(name->data),
                        .dims = std::move(*lengths),
                        .is_numeric = kind >= kFirstNumeric && kind <= kLastNumeric,
                        .is_complex = (word & kComplex) != 0,
                        .is_compressed = is_compressed,
                        .content = content,
                        .numbers_begin = size - begin.size()});
}

const MatFile::Variable* MatFile::find(const std::string& name) const {
  const auto found = std::find_if(variables_.begin(), variables_.end(),
                                  [&](const Variable& variable) { return variable.name == name; });
  return found == variables_.end() ? nullptr : &*found;
}

void MatFile::fail(const std::string& name, const std::string& got,
                   const std::string& expected) const {
  throw InvalidInput(
      fmt::format("{}: variable '{}': got {}, expected {}", name_, name, got, expected));
}

MatArray MatFile::array(const std::string& name, std::size_t most) const {
  const Variable* variable = find(name);
  if (variable == nullptr) fail(name, "none", "an array of numbers");
  std::size_t count = 1;
  for (const std::size_t dim : variable->dims) {
    if (dim > most || (count *= dim) > most)
      fail(name, describe_dims(variable->dims) + " numbers", fmt::format("at most {}", most));
  }
  if (!variable->is_numeric) fail(name, "something else", "an array of numbers");
  if (variable->is_complex) fail(name, "complex numbers", "real ones");

  const std::size_t tag = variable->is_compressed ? kMatTag : 0;
  const std::size_t begin = tag + variable->numbers_begin;
  std::optional<Inflated> uncompressed;
  std::string_view bytes = variable->content;
  if (variable->is_compressed) {
    // Nothing follows the numbers but less than a tag of padding.
    uncompressed = inflated_prefix(variable->content, begin + 2 * kMatTag + count * sizeof(double));
    if (!uncompressed || !uncompressed->is_whole) fail(name, "damaged data", "numbers");
    bytes = uncompressed->bytes;
  }
  bytes.remove_prefix(std::min(begin, bytes.size()));
  const auto element = take_element(bytes, little_endian_);
  auto numbers = element ? element->numbers(little_endian_) : std::nullopt;
  if (!numbers || numbers->size() != count) fail(name, "damaged data", "numbers");
  for (const double number : *numbers)
    if (!std::isfinite(number)) fail(name, fmt::format("the number {}", number), "finite ones");
  return {variable->dims, std::move(*numbers)};
}

std::string describe_dims(const std::vector<std::size_t>& dims) {
  return fmt::format("{}", fmt::join(dims, "x"));
}

}  // namespace posemix::internal
