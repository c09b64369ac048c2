// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "compression.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <new>
#include <stdexcept>

#include <zlib.h>

namespace posemix::internal {
namespace {

const Bytef* zlib_bytes(std::string_view bytes) {
  return reinterpret_cast<const Bytef*>(bytes.data());
}

}  // namespace

struct Deflater::State {
  z_stream stream{};
};

Deflater::Deflater() : state_(std::make_unique<State>()) {
  if (deflateInit(&state_->stream, Z_DEFAULT_COMPRESSION) != Z_OK) throw std::bad_alloc();
}

Deflater::~Deflater() { deflateEnd(&state_->stream); }

void Deflater::run(int flush) {
  z_stream& stream = state_->stream;
  std::array<Bytef, 65536> buffer;
  do {
    stream.next_out = buffer.data();
    stream.avail_out = buffer.size();
    deflate(&stream, flush);
    const std::size_t got = buffer.size() - stream.avail_out;
    stream_.append(reinterpret_cast<const char*>(buffer.data()), got);
  } while (stream.avail_out == 0);
}

void Deflater::add(std::string_view bytes) {
  constexpr std::size_t kMost = std::numeric_limits<uInt>::max();
  while (!bytes.empty()) {
    const std::string_view piece = bytes.substr(0, kMost);
    // zlib does not write to its input.
    state_->stream.next_in = const_cast<Bytef*>(zlib_bytes(piece));
    state_->stream.avail_in = static_cast<uInt>(piece.size());
    run(Z_NO_FLUSH);
    bytes.remove_prefix(piece.size());
  }
}

std::string Deflater::finish() {
  run(Z_FINISH);
  return std::move(stream_);
}

std::string inflated(std::string_view stream, std::size_t size) {
  std::string bytes(size, '\0');
  uLongf got = size;
  const int result =
      uncompress(reinterpret_cast<Bytef*>(bytes.data()), &got, zlib_bytes(stream), stream.size());
  if (result != Z_OK || got != size) throw std::runtime_error("a damaged zlib stream");
  return bytes;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::string_view group = bytes.substr(at, 3);
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      bits = bits << 8U | (i < group.size() ? static_cast<unsigned char>(group[i]) : 0U);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      text += i <= group.size() ? kDigits[bits >> (18 - 6 * i) & 63U] : '=';
    }
  }
  return text;
}

}  // namespace posemix::internal
