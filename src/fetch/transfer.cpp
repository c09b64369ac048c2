// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "transfer.hpp"

#include <exception>

#include <fmt/format.h>

#include "download.hpp"
#include "posemix/base/error.hpp"
#include "sources.hpp"

namespace posemix {
namespace {

constexpr long kOk = 200;
constexpr long kPartOfFile = 206;
constexpr long kNoSuchRange = 416;
constexpr long kMostRedirects = 8;
constexpr long kConnectSeconds = 30;
constexpr long kSilentSeconds = 60;

/// Statuses after which a retry may succeed.
bool is_transient(long code) { return code == 408 || code == 429 || (code >= 500 && code <= 599); }

std::string_view meaning(long code) {
  switch (code) {
    case 401:
    case 403:
      return " (not allowed)";
    case 404:
    case 410:
      return " (not there)";
    case 429:
      return " (too many requests)";
    default:
      return code >= 500 ? " (an error of the server)" : "";
  }
}

}  // namespace

Transfer::Transfer(CURL* curl, std::string url, bool allow_http, Sink& sink,
                   const std::optional<std::uint64_t>& size, const ByteProgress& progress)
    : curl_(curl),
      url_(std::move(url)),
      allow_http_(allow_http),
      sink_(sink),
      size_(size),
      progress_(progress) {}

void Transfer::set_options() {
  curl_easy_reset(curl_);
  const char* protocols = url_.starts_with("http://") ? "http,https" : "https";
  curl_easy_setopt(curl_, CURLOPT_URL, url_.c_str());
  curl_easy_setopt(curl_, CURLOPT_PROTOCOLS_STR, protocols);
  curl_easy_setopt(curl_, CURLOPT_REDIR_PROTOCOLS_STR, protocols);
  curl_easy_setopt(curl_, CURLOPT_FOLLOWLOCATION, 1L);
  curl_easy_setopt(curl_, CURLOPT_MAXREDIRS, kMostRedirects);
  curl_easy_setopt(curl_, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl_, CURLOPT_USERAGENT, "posemix");
  curl_easy_setopt(curl_, CURLOPT_CONNECTTIMEOUT, kConnectSeconds);
  curl_easy_setopt(curl_, CURLOPT_LOW_SPEED_LIMIT, 1L);
  curl_easy_setopt(curl_, CURLOPT_LOW_SPEED_TIME, kSilentSeconds);
  curl_easy_setopt(curl_, CURLOPT_ERRORBUFFER, static_cast<char*>(reason_));
  curl_easy_setopt(curl_, CURLOPT_WRITEFUNCTION, &Transfer::on_body);
  curl_easy_setopt(curl_, CURLOPT_WRITEDATA, this);
  curl_easy_setopt(curl_, CURLOPT_NOPROGRESS, 0L);
  curl_easy_setopt(curl_, CURLOPT_XFERINFOFUNCTION, &Transfer::on_progress);
  curl_easy_setopt(curl_, CURLOPT_XFERINFODATA, this);
  if (offset_ > 0) curl_easy_setopt(curl_, CURLOPT_RANGE, fmt::format("{}-", offset_).c_str());
}

bool Transfer::guarded(const std::function<void()>& action) {
  try {
    action();
    return true;
  } catch (...) {
    error_ = std::current_exception();
    return false;
  }
}

std::size_t Transfer::on_body(char* data, std::size_t unit, std::size_t count, void* self) {
  auto& transfer = *static_cast<Transfer*>(self);
  const std::size_t size = unit * count;
  return transfer.guarded([&] { transfer.take({data, size}); }) ? size : 0;
}

int Transfer::on_progress(void* self, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  auto& transfer = *static_cast<Transfer*>(self);
  const bool on = transfer.guarded([&] {
    if (transfer.progress_ && !transfer.progress_(transfer.sink_.size())) transfer.stopped_ = true;
  });
  return on && !transfer.stopped_ ? 0 : 1;
}

long Transfer::code() const {
  long code = 0;
  curl_easy_getinfo(curl_, CURLINFO_RESPONSE_CODE, &code);
  return code;
}

bool Transfer::continues() const {
  curl_header* header = nullptr;
  if (curl_easy_header(curl_, "Content-Range", 0, CURLH_HEADER, -1, &header) != CURLHE_OK)
    return false;
  return std::string_view(header->value).starts_with(fmt::format("bytes {}-", offset_));
}

void Transfer::begin() {
  begun_ = true;
  const char* address = nullptr;
  curl_easy_getinfo(curl_, CURLINFO_EFFECTIVE_URL, &address);
  if (address != nullptr) check_url(address, allow_http_);
  if (code() == kPartOfFile && !continues())
    throw NetworkError(fmt::format("{}: the server sent another part than was asked for", url_),
                       false);
  if (code() == kOk && offset_ > 0) sink_.clear();
}

void Transfer::take(std::string_view bytes) {
  if (code() != kOk && code() != kPartOfFile) return;
  if (!begun_) begin();
  if (size_ && sink_.size() + bytes.size() > *size_) {
    sink_.clear();
    throw InvalidInput(fmt::format(
        "{}: got more than {} bytes, expected a file of that size; nothing of it is kept", url_,
        *size_));
  }
  sink_.append(bytes);
}

void Transfer::fail(CURLcode reason) const {
  const std::string why = *reason_ != '\0' ? reason_ : curl_easy_strerror(reason);
  if (!begun_) throw NetworkError(fmt::format("{}: {}", url_, why), true);
  const std::string of = size_ ? fmt::format(" of {}", *size_) : "";
  throw NetworkError(fmt::format("{}: ended after {}{} bytes ({})", url_, sink_.size(), of, why),
                     true);
}

bool Transfer::perform() {
  check_url(url_, allow_http_);
  offset_ = sink_.size();
  set_options();
  const CURLcode result = curl_easy_perform(curl_);
  if (error_) std::rethrow_exception(error_);
  if (stopped_) return false;
  const bool has_answer = result == CURLE_OK;
  if (has_answer && code() == kNoSuchRange && offset_ > 0) {
    sink_.clear();
    return perform();
  }
  if (has_answer && code() != kOk && code() != kPartOfFile) {
    throw NetworkError(fmt::format("{}: the server answers {}{}", url_, code(), meaning(code())),
                       is_transient(code()));
  }
  if (!has_answer) fail(result);
  if (!begun_) begin();
  if (size_ && sink_.size() < *size_) fail(CURLE_PARTIAL_FILE);
  return true;
}

}  // namespace posemix
