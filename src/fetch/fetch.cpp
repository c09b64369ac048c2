// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "fetch.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <exception>
#include <system_error>

#include <fmt/format.h>

#include "paths.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/output_file.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kLockPeriod{2};

/// The expected size and hash of a file.
struct Expectation {
  std::optional<std::uint64_t> size;
  std::string sha256;  ///< empty: unknown
  HashCheck check = HashCheck::none;
};

std::string_view origin_of(HashCheck check) {
  return check == HashCheck::pinned ? "the registry's" : "the one its host publishes";
}

bool is_file_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

/// Fetches the files of one source.
class Fetch {
 public:
  Fetch(const DataSource& source, const std::vector<SourceFile>& files, fs::path folder,
        const ConnectionSettings& settings, const FetchWatcher& watcher)
      : source_(source),
        files_(files),
        folder_(std::move(folder)),
        connection_(settings),
        watcher_(watcher),
        lock_(read_lock_file(folder_)) {
    if (!lock_.source.empty() && lock_.source != source.name) {
      throw InvalidInput(fmt::format("{}: got a folder that holds '{}', expected '{}'",
                                     (folder_ / kLockFileName).string(), lock_.source,
                                     source.name));
    }
    lock_.source = source.name;
    lock_.revision = source.revision;
    progress_.files = files.size();
    progress_.bytes = total_size();
  }

  FetchReport run() {
    try {
      for (const SourceFile& file : files_) {
        report_.stopped = !handle(file);
        if (report_.stopped) break;
        ++progress_.files_done;
        if (std::chrono::steady_clock::now() >= next_lock_) write_lock();
      }
    } catch (...) {
      note_what_came();
      throw;
    }
    write_lock();
    return report_;
  }

 private:
  std::optional<std::uint64_t> total_size() const {
    std::uint64_t total = 0;
    for (const SourceFile& file : files_) {
      if (!file.size) return std::nullopt;
      total += *file.size;
    }
    return total;
  }

  ByteProgress byte_progress() {
    return [this](std::uint64_t bytes) {
      FetchProgress now = progress_;
      now.bytes_done += bytes;
      return !watcher_ || watcher_(now);
    };
  }

  void write_lock() {
    next_lock_ = std::chrono::steady_clock::now() + kLockPeriod;
    if (!lock_.files.empty()) write_output_file(folder_ / kLockFileName, format_lock_file(lock_));
  }

  /// Writes the lock file after an error. A second error, such as a full disk, is dropped in favour
  /// of the first.
  void note_what_came() noexcept {
    try {
      write_lock();
    } catch (const std::exception&) {
      // A file without an entry is compared again in the next run.
    }
  }

  /// The size and hash that the host publishes. Empty if the fetch was stopped.
  std::optional<Expectation> published(const SourceFile& file) {
    const std::string url = source_.published_url_of(file);
    bool stopped = false;
    const std::string text = connection_.get_text(url, [&](std::uint64_t) {
      stopped = !byte_progress()(0);
      return !stopped;
    });
    if (stopped) return std::nullopt;
    const FileContent content = parse_lfs_pointer(text, url);
    const auto known = lock_.files.find(file.path);
    if (known != lock_.files.end() && known->second.sha256 != content.sha256) {
      throw InvalidInput(
          fmt::format("{}: the host now publishes SHA-256 {}, expected {} as fetched on {}", url,
                      content.sha256, known->second.sha256, known->second.date));
    }
    return Expectation{content.size, content.sha256, HashCheck::published};
  }

  /// The expected size and hash of the file. For a file that is `there`, the entry of its fetch
  /// suffices.
  std::optional<Expectation> expectation(const SourceFile& file, bool there) {
    if (!file.sha256.empty()) return Expectation{file.size, file.sha256, HashCheck::pinned};
    const auto known = lock_.files.find(file.path);
    const bool is_known = known != lock_.files.end();
    if (file.published && !(there && is_known)) return published(file);
    if (is_known) return Expectation{known->second.size, known->second.sha256, known->second.check};
    return Expectation{file.size, "", HashCheck::none};
  }

  /// Returns false if it was stopped.
  bool handle(const SourceFile& file) {
    const fs::path target = folder_ / file.path;
    const bool there = is_file_there(target);
    const auto expected = expectation(file, there);
    if (!expected) return false;
    const auto content = there ? compare(target, *expected) : get(file, target, *expected);
    if (!content) return false;
    (there ? report_.there_already : report_.fetched) += 1;
    const std::array<std::size_t*, 3> counts{&report_.pinned, &report_.published,
                                             &report_.unchecked};
    ++*counts[static_cast<std::size_t>(expected->check)];
    report_.bytes += content->size;
    progress_.bytes_done += content->size;
    const auto known = lock_.files.find(file.path);
    const std::string date =
        there && known != lock_.files.end() ? known->second.date : download_time();
    lock_.files[file.path] = {source_.url_of(file), content->size, content->sha256, expected->check,
                              date};
    return true;
  }

  /// Size and hash of an existing file.
  std::optional<FileContent> compare(const fs::path& target, const Expectation& expected) {
    auto content = content_of_file(target, byte_progress());
    if (content && !expected.sha256.empty() && content->sha256 != expected.sha256) {
      throw InvalidInput(fmt::format(
          "{}: got SHA-256 {}, expected {} ({}): the file was there before and is "
          "another; remove it to fetch it",
          target.string(), content->sha256, expected.sha256, origin_of(expected.check)));
    }
    return content;
  }

  std::optional<FileContent> get(const SourceFile& file, const fs::path& target,
                                 const Expectation& expected) {
    make_parents(target);
    const fs::path part = target.string() + ".part";
    const bool resumed = is_file_there(part) && fs::file_size(part) > 0;
    auto content = get_part(file, part, expected);
    if (content && is_wrong(*content, expected) && resumed) {
      fs::remove(part);  // it belongs to another file
      content = get_part(file, part, expected);
    }
    if (!content) {
      if (is_file_there(part)) report_.part = part;
      return std::nullopt;
    }
    if (is_wrong(*content, expected)) {
      fs::remove(part);
      throw InvalidInput(fmt::format(
          "{}: got SHA-256 {}, expected {} ({}): what came is not the file that was "
          "meant; nothing of it is kept",
          source_.url_of(file), content->sha256, expected.sha256, origin_of(expected.check)));
    }
    put_in_place(part, target);
    return content;
  }

  static bool is_wrong(const FileContent& content, const Expectation& expected) {
    return !expected.sha256.empty() && content.sha256 != expected.sha256;
  }

  std::optional<FileContent> get_part(const SourceFile& file, const fs::path& part,
                                      const Expectation& expected) {
    if (!connection_.get(source_.url_of(file), part, expected.size, byte_progress()))
      return std::nullopt;
    return content_of_file(part, byte_progress());
  }

  static void make_parents(const fs::path& target) {
    std::error_code error;
    fs::create_directories(target.parent_path(), error);
    if (error)
      throw OutputError(
          fmt::format("{}: cannot be made: {}", target.parent_path().string(), error.message()));
  }

  static void put_in_place(const fs::path& part, const fs::path& target) {
    if (std::rename(part.c_str(), target.c_str()) != 0)
      throw OutputError(
          fmt::format("{}: cannot be written: {}", target.string(), std::strerror(errno)));
  }

  const DataSource& source_;
  const std::vector<SourceFile>& files_;
  fs::path folder_;
  Connection connection_;
  const FetchWatcher& watcher_;
  LockFile lock_;
  FetchProgress progress_;
  FetchReport report_;
  std::chrono::steady_clock::time_point next_lock_ = std::chrono::steady_clock::now() + kLockPeriod;
};

}  // namespace

std::vector<SourceFile> selected_files(const DataSource& source,
                                       const std::vector<std::string>& patterns) {
  std::vector<SourceFile> files;
  std::vector<bool> used(patterns.size(), false);
  for (const SourceFile& file : source.files) {
    bool wanted = patterns.empty() && !file.optional;
    for (std::size_t i = 0; i < patterns.size(); ++i) {
      if (!matches_pattern(file.path, patterns[i])) continue;
      used[i] = true;
      wanted = true;
    }
    if (wanted) files.push_back(file);
  }
  const auto unused = std::find(used.begin(), used.end(), false);
  if (unused != used.end()) {
    throw InvalidInput(fmt::format("{} matches no file of '{}'; see `posemix data list {}`",
                                   in_quotes(patterns[unused - used.begin()], 200), source.name,
                                   source.name));
  }
  return files;
}

FetchReport fetch_files(const DataSource& source, const std::vector<SourceFile>& files,
                        const fs::path& folder, const ConnectionSettings& settings,
                        const FetchWatcher& watcher) {
  return Fetch(source, files, folder, settings, watcher).run();
}

FileContent parse_lfs_pointer(std::string_view text, const std::string& name) {
  constexpr std::string_view kVersion = "version https://git-lfs.github.com/spec/v1";
  constexpr std::string_view kHash = "oid sha256:";
  constexpr std::string_view kSize = "size ";
  FileContent content;
  std::optional<std::int64_t> size;
  bool has_version = false;
  for (const std::string_view line : split_fields(text, '\n')) {
    if (line == kVersion) has_version = true;
    if (line.starts_with(kHash)) content.sha256 = line.substr(kHash.size());
    if (line.starts_with(kSize)) size = parse_integer(line.substr(kSize.size()));
  }
  if (!has_version || !is_sha256(content.sha256) || !size || *size < 0) {
    throw InvalidInput(
        fmt::format("{}: got {}, expected a Git LFS pointer with the hash that the "
                    "host publishes",
                    name, in_quotes(text, 80)));
  }
  content.size = static_cast<std::uint64_t>(*size);
  return content;
}

}  // namespace posemix
