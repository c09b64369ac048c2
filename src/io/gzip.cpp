// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/gzip.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "inflater.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

using namespace internal;

constexpr int kGzipWindow = MAX_WBITS + 16;  ///< zlib's word for gzip
constexpr std::size_t kMostBytes = std::size_t{1} << 30;
constexpr std::size_t kPiece = std::size_t{1} << 18;

bool is_gzip(std::string_view bytes) { return bytes.substr(0, 2) == "\x1f\x8b"; }

std::string uncompressed(std::string_view bytes, const std::string& name) {
  Inflater inflater(kGzipWindow);
  z_stream& stream = inflater.stream;
  stream.next_in = zlib_bytes(bytes);
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::string text;
  std::string piece(kPiece, '\0');
  for (bool more = true; more;) {
    stream.next_out = zlib_bytes(piece);
    stream.avail_out = static_cast<uInt>(piece.size());
    const int status = inflate(&stream, Z_NO_FLUSH);
    if (status != Z_OK && status != Z_STREAM_END)
      throw InvalidInput(fmt::format("{}: got a damaged gzip file, expected a whole one", name));
    text.append(piece.data(), piece.size() - stream.avail_out);
    if (text.size() > kMostBytes)
      throw InvalidInput(fmt::format("{}: got more than 1 GiB, expected less", name));
    if (status != Z_STREAM_END) continue;
    // A gzip file may have several members, one after the other.
    more = stream.avail_in > 0;
    if (more) inflateReset(&stream);
  }
  return text;
}

}  // namespace

std::string read_file_or_gzip(const std::filesystem::path& path) {
  std::string bytes = read_file(path);
  return is_gzip(bytes) ? uncompressed(bytes, path.string()) : bytes;
}

std::string gzip(std::string_view bytes) {
  z_stream stream{};
  if (bytes.size() > std::numeric_limits<uInt>::max())
    throw std::length_error("too much for one gzip file");
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzipWindow, MAX_MEM_LEVEL,
                   Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  std::string out(deflateBound(&stream, static_cast<uLong>(bytes.size())), '\0');
  stream.next_in = zlib_bytes(bytes);
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = zlib_bytes(out);
  stream.avail_out = static_cast<uInt>(out.size());
  const int status = deflate(&stream, Z_FINISH);
  out.erase(stream.total_out);
  deflateEnd(&stream);
  if (status != Z_STREAM_END) throw std::runtime_error("zlib could not compress");
  return out;
}

}  // namespace posemix
