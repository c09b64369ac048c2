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

/// The network or a server did not do what was asked: the message names the address and the reason.
class NetworkError : public std::runtime_error {
 public:
  /// `transient`: it may work when it is tried again.
  NetworkError(const std::string& message, bool transient)
      : std::runtime_error(message), transient_(transient) {}
  bool transient() const { return transient_; }

 private:
  bool transient_;
};

struct ConnectionSettings {
  bool allow_http = false;  ///< addresses of other machines that are not encrypted, too
  int retries = 4;          ///< after a transient error without progress
  std::chrono::milliseconds first_wait{1000};  ///< before the first retry; doubles
};

/// Fetches by HTTP, one file after the other over the same connection where the server lets it.
class Connection {
 public:
  explicit Connection(const ConnectionSettings& settings);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Fetches the rest of a file: what `part` holds already is asked for no more, unless the server
  /// cannot answer so. True when all is there, false when `progress` stopped it; what has come
  /// stays in `part`.
  /// @throws NetworkError, InvalidInput (an address or answer that is refused), OutputError
  bool get(const std::string& url, const std::filesystem::path& part,
           const std::optional<std::uint64_t>& size, const ByteProgress& progress);

  /// A short text. @throws as get
  std::string get_text(const std::string& url, const ByteProgress& progress);

 private:
  struct Handle;
  ConnectionSettings settings_;
  std::unique_ptr<Handle> handle_;
};

}  // namespace posemix
