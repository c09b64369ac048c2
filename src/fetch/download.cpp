// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "download.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <functional>
#include <new>
#include <thread>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "base/uninterrupted.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/output_folder.hpp"
#include "transfer.hpp"

namespace posemix {
namespace {

constexpr std::size_t kLongestText = 1U << 16U;
constexpr std::chrono::milliseconds kNap{50};

/// The file that a download is appended to.
class PartFile : public Sink {
 public:
  explicit PartFile(const std::filesystem::path& path)
      : path_(path), number_(internal::uninterrupted([&] {
          return ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
        })) {
    struct stat status {};
    if (number_ < 0 || ::fstat(number_, &status) != 0) fail_write();
    size_ = static_cast<std::uint64_t>(status.st_size);
  }
  ~PartFile() override {
    if (number_ >= 0) ::close(number_);
  }
  PartFile(const PartFile&) = delete;
  PartFile(PartFile&&) = delete;
  PartFile& operator=(const PartFile&) = delete;
  PartFile& operator=(PartFile&&) = delete;

  std::uint64_t size() const override { return size_; }
  void clear() override {
    if (internal::uninterrupted([&] { return ::ftruncate(number_, 0); }) != 0) fail_write();
    size_ = 0;
  }
  void append(std::string_view bytes) override {
    while (!bytes.empty()) {
      const ssize_t written = internal::uninterrupted(
          [&] { return ::pwrite(number_, bytes.data(), bytes.size(), static_cast<off_t>(size_)); });
      if (written < 0) fail_write();
      bytes.remove_prefix(static_cast<std::size_t>(written));
      size_ += static_cast<std::uint64_t>(written);
    }
  }
  void sync() {
    const int status = internal::uninterrupted([&] { return ::fsync(number_); });
    if (status != 0 && errno != EINVAL && errno != EROFS) fail_write();
  }

 private:
  [[noreturn]] void fail_write() const {
    throw OutputError(
        fmt::format("{}: cannot be written: {}; what is there stays, and the next "
                    "run resumes",
                    path_.string(), std::strerror(errno)));
  }

  std::filesystem::path path_;
  int number_;
  std::uint64_t size_ = 0;
};

class TextDownload : public Sink {
 public:
  explicit TextDownload(std::string& text) : text_(text) {}
  std::uint64_t size() const override { return text_.size(); }
  void clear() override { text_.clear(); }
  void append(std::string_view bytes) override {
    if (text_.size() + bytes.size() > kLongestText)
      throw InvalidInput(
          fmt::format("got an answer of more than {} bytes, expected a short text", kLongestText));
    text_ += bytes;
  }

 private:
  std::string& text_;
};

/// Waits. Returns false if `progress` stops the wait.
bool wait(std::chrono::milliseconds time, const ByteProgress& progress, std::uint64_t bytes) {
  const auto end = std::chrono::steady_clock::now() + time;
  while (std::chrono::steady_clock::now() < end) {
    if (progress && !progress(bytes)) return false;
    std::this_thread::sleep_for(std::min(kNap, time));
  }
  return true;
}

/// Retries until the transfer succeeds, makes no more progress, or is stopped.
bool persist(const ConnectionSettings& settings, Sink& sink, const ByteProgress& progress,
             const std::function<bool()>& attempt) {
  int left = settings.retries;
  std::chrono::milliseconds pause = settings.first_wait;
  while (true) {
    const std::uint64_t before = sink.size();
    try {
      return attempt();
    } catch (const NetworkError& error) {
      if (sink.size() > before) {
        left = settings.retries;
        pause = settings.first_wait;
      }
      if (!error.transient() || left-- <= 0) throw;
    }
    if (!wait(pause, progress, sink.size())) return false;
    pause *= 2;
  }
}

}  // namespace

void check_can_fetch() {}

struct Connection::Handle {
  Handle() : curl(curl_easy_init()) {
    if (curl == nullptr) throw std::bad_alloc();
  }
  ~Handle() { curl_easy_cleanup(curl); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  CURL* curl;
};

Connection::Connection(const ConnectionSettings& settings)
    : settings_(settings), handle_(std::make_unique<Handle>()) {}

Connection::~Connection() = default;

bool Connection::get(const std::string& url, const std::filesystem::path& part,
                     const std::optional<std::uint64_t>& size, const ByteProgress& progress) {
  PartFile file(part);
  if (size && file.size() > *size) file.clear();
  const auto attempt = [&] {
    if (size && file.size() == *size) return true;
    return Transfer(handle_->curl, url, settings_.allow_http, file, size, progress).perform();
  };
  const bool complete = persist(settings_, file, progress, attempt);
  if (complete) file.sync();
  return complete;
}

std::string Connection::get_text(const std::string& url, const ByteProgress& progress) {
  std::string text;
  TextDownload sink(text);
  persist(settings_, sink, progress, [&] {
    sink.clear();
    return Transfer(handle_->curl, url, settings_.allow_http, sink, std::nullopt, progress)
        .perform();
  });
  return text;
}

}  // namespace posemix
