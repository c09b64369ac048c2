// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "checksum.hpp"

namespace posemix {

/// Does nothing where this build can download, check and unpack files.
/// @throws InvalidInput where it cannot
void check_can_fetch();

/// A failure of the network or of a server. The message names the address and the reason.
class NetworkError : public std::runtime_error {
 public:
  /// `transient`: a retry may succeed.
  NetworkError(const std::string& message, bool transient)
      : std::runtime_error(message), transient_(transient) {}
  bool transient() const { return transient_; }

 private:
  bool transient_;
};

struct ConnectionSettings {
  bool allow_http = false;                     ///< allow unencrypted addresses on other machines
  int retries = 4;                             ///< after a transient error without progress
  std::chrono::milliseconds first_wait{1000};  ///< before the first retry; doubles
};

/// Fetches files by HTTP, one after the other, over one connection if the server allows it.
class Connection {
 public:
  explicit Connection(const ConnectionSettings& settings);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Fetches the rest of a file: the bytes that `part` has already are not requested again, unless
  /// the server cannot resume. Returns true if the file is complete, false if `progress` stopped
  /// the transfer; `part` keeps the bytes received.
  /// @throws NetworkError, InvalidInput (an address or answer that is refused), OutputError
  bool get(const std::string& url, const std::filesystem::path& part,
           const std::optional<std::uint64_t>& size, const ByteProgress& progress);

  /// Fetches a short text. @throws as get
  std::string get_text(const std::string& url, const ByteProgress& progress);

 private:
  struct Handle;
  ConnectionSettings settings_;
  std::unique_ptr<Handle> handle_;
};

}  // namespace posemix
