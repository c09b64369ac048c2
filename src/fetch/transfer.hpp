// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include <curl/curl.h>

#include "checksum.hpp"

namespace posemix {

/// Destination of the bytes of an answer.
class Sink {
 public:
  Sink() = default;
  Sink(const Sink&) = delete;
  Sink& operator=(const Sink&) = delete;
  virtual ~Sink() = default;

  virtual std::uint64_t size() const = 0;
  /// Discards all bytes. @throws OutputError
  virtual void clear() = 0;
  /// @throws OutputError
  virtual void append(std::string_view bytes) = 0;
};

/// One request and its answer.
class Transfer {
 public:
  Transfer(CURL* curl, std::string url, bool allow_http, Sink& sink,
           const std::optional<std::uint64_t>& size, const ByteProgress& progress);

  /// Returns true if the transfer is complete, false if it was stopped.
  /// @throws NetworkError, and what the sink and check_url throw
  bool perform();

 private:
  static std::size_t on_body(char* data, std::size_t unit, std::size_t count, void* self);
  static int on_progress(void* self, curl_off_t, curl_off_t, curl_off_t, curl_off_t);

  void set_options();
  void take(std::string_view bytes);
  /// Checks the head of the answer before its first byte.
  void begin();
  bool continues() const;
  long code() const;
  /// Runs code that may throw inside a callback of libcurl; returns false after an exception.
  bool guarded(const std::function<void()>& action);
  [[noreturn]] void fail(CURLcode reason) const;

  CURL* curl_;
  std::string url_;
  bool allow_http_;
  Sink& sink_;
  std::optional<std::uint64_t> size_;
  const ByteProgress& progress_;
  std::uint64_t offset_ = 0;
  bool begun_ = false;
  bool stopped_ = false;
  std::exception_ptr error_;
  char reason_[CURL_ERROR_SIZE] = {};
};

}  // namespace posemix
