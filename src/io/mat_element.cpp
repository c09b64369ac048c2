// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "mat_element.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "inflater.hpp"

namespace posemix::internal {
namespace {

constexpr std::size_t kAlignment = 8;  ///< where elements begin
constexpr std::size_t kSmall = 4;      ///< the bytes that fit into a tag

template <typename Number>
Number number_at(const char* at, bool little_endian) {
  std::array<char, sizeof(Number)> bytes;
  std::copy_n(at, bytes.size(), bytes.begin());
  if (little_endian != (std::endian::native == std::endian::little))
    std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<Number>(bytes);
}

template <typename Number>
std::optional<std::vector<double>> numbers_of(std::string_view data, bool little_endian) {
  if (data.size() % sizeof(Number) != 0) return std::nullopt;
  std::vector<double> numbers;
  numbers.reserve(data.size() / sizeof(Number));
  for (std::size_t at = 0; at < data.size(); at += sizeof(Number))
    numbers.push_back(static_cast<double>(number_at<Number>(data.data() + at, little_endian)));
  return numbers;
}

}  // namespace

std::optional<std::vector<double>> MatElement::numbers(bool little_endian) const {
  switch (type) {
    case MatType::int8:
      return numbers_of<std::int8_t>(data, little_endian);
    case MatType::uint8:
      return numbers_of<std::uint8_t>(data, little_endian);
    case MatType::int16:
      return numbers_of<std::int16_t>(data, little_endian);
    case MatType::uint16:
      return numbers_of<std::uint16_t>(data, little_endian);
    case MatType::int32:
      return numbers_of<std::int32_t>(data, little_endian);
    case MatType::uint32:
      return numbers_of<std::uint32_t>(data, little_endian);
    case MatType::single_precision:
      return numbers_of<float>(data, little_endian);
    case MatType::double_precision:
      return numbers_of<double>(data, little_endian);
    case MatType::int64:
      return numbers_of<std::int64_t>(data, little_endian);
    case MatType::uint64:
      return numbers_of<std::uint64_t>(data, little_endian);
    default:
      return std::nullopt;
  }
}

std::optional<MatElement> take_element(std::string_view& bytes, bool little_endian) {
  if (bytes.size() < kMatTag) return std::nullopt;
  const auto word = number_at<std::uint32_t>(bytes.data(), little_endian);
  // An element of up to four bytes has size and type in one word, and the bytes behind it.
  if (const std::size_t size = word >> 16; size != 0) {
    if (size > kSmall) return std::nullopt;
    const MatElement element{MatType{word & 0xffffU}, bytes.substr(kSmall, size)};
    bytes.remove_prefix(kMatTag);
    return element;
  }
  const std::size_t size = number_at<std::uint32_t>(bytes.data() + 4, little_endian);
  if (size > bytes.size() - kMatTag) return std::nullopt;
  const MatElement element{MatType{word}, bytes.substr(kMatTag, size)};
  // A compressed element is followed by the next without padding; the last may lack its own.
  const std::size_t padding =
      element.type == MatType::compressed ? 0 : (kAlignment - size % kAlignment) % kAlignment;
  bytes.remove_prefix(std::min(bytes.size(), kMatTag + size + padding));
  return element;
}

std::optional<Inflated> inflated_prefix(std::string_view stream, std::size_t most) {
  Inflater inflater(MAX_WBITS);
  z_stream& zlib = inflater.stream;
  zlib.next_in = zlib_bytes(stream);
  zlib.avail_in = static_cast<uInt>(stream.size());  // elements have less than 4 GiB
  constexpr std::size_t kFirst = 4096;
  std::string bytes;
  int status = Z_OK;
  // The memory grows with what there is, not with what a damaged size says.
  for (std::size_t size = std::min(most, kFirst); status == Z_OK; size = std::min(most, 2 * size)) {
    const std::size_t before = bytes.size();
    if (before == size) break;
    bytes.resize(size);
    zlib.next_out = zlib_bytes(bytes) + before;
    zlib.avail_out = static_cast<uInt>(size - before);
    status = inflate(&zlib, Z_NO_FLUSH);
    bytes.resize(size - zlib.avail_out);
  }
  if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR) return std::nullopt;
  return Inflated{std::move(bytes), status == Z_STREAM_END};
}

}  // namespace posemix::internal
