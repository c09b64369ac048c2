// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <memory>
#include <string>
#include <string_view>

/// zlib streams (RFC 1950) and base64 (RFC 4648).
namespace posemix::internal {

/// Compresses bytes that come in pieces.
class Deflater {
 public:
  Deflater();
  ~Deflater();
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;

  void add(std::string_view bytes);
  /// Bytes of the stream so far; what was added lately may not be among them.
  std::size_t size() const { return stream_.size(); }
  /// Ends the stream and returns it; nothing can be added afterwards.
  std::string finish();

 private:
  struct State;
  void run(int flush);

  std::unique_ptr<State> state_;
  std::string stream_;
};

/// The bytes of a whole zlib stream of known uncompressed size.
/// @throws std::runtime_error for a damaged stream or another size
std::string inflated(std::string_view stream, std::size_t size);

std::string base64(std::string_view bytes);

}  // namespace posemix::internal
