// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "unpack.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string_view>
#include <system_error>

#include <archive.h>
#include <archive_entry.h>
#include <fcntl.h>
#include <unistd.h>

#include <fmt/format.h>

#include "base/uninterrupted.hpp"
#include "paths.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/output_folder.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kReadBlock = 1U << 18U;

/// What an archive may hold: recordings are images, which hardly shrink, and text.
constexpr std::size_t kMostEntries = 1000000;
constexpr std::ptrdiff_t kDeepest = 32;
constexpr std::uint64_t kMostTimesLarger = 100;
constexpr std::uint64_t kAlwaysAllowed = std::uint64_t{1} << 30U;

[[noreturn]] void fail_unpack(const fs::path& path) {
  throw OutputError(fmt::format("{}: cannot be unpacked: {}", path.string(), std::strerror(errno)));
}

class Archive {
 public:
  explicit Archive(const fs::path& path)
      : path_(path), archive_(archive_read_new(), archive_read_free) {
    archive_read_support_format_zip(archive_.get());
    archive_read_support_format_tar(archive_.get());
    // Not all that there are: some start a program.
    archive_read_support_filter_gzip(archive_.get());
    archive_read_support_filter_bzip2(archive_.get());
    archive_read_support_filter_xz(archive_.get());
    check(archive_read_open_filename(archive_.get(), path.c_str(), kReadBlock));
    std::error_code error;
    const std::uintmax_t size = fs::file_size(path, error);
    left_ = kAlwaysAllowed + (error ? 0 : kMostTimesLarger * size);
  }

  /// The next entry; null at the end.
  archive_entry* next() {
    archive_entry* entry = nullptr;
    const int status = archive_read_next_header(archive_.get(), &entry);
    if (status == ARCHIVE_EOF) return nullptr;
    check(status);
    if (++entries_ > kMostEntries)
      refuse(fmt::format("more than {} entries", kMostEntries), "fewer");
    return entry;
  }

  void write_to(int file, const fs::path& target) {
    const void* block = nullptr;
    std::size_t size = 0;
    la_int64_t offset = 0;
    end_ = 0;
    while (true) {
      const int status = archive_read_data_block(archive_.get(), &block, &size, &offset);
      if (status == ARCHIVE_EOF) return;
      check(status);
      // A hole that is left out counts, too.
      const auto end = static_cast<std::uint64_t>(offset) + size;
      spend(end - std::min(end, end_));
      end_ = std::max(end, end_);
      std::string_view rest(static_cast<const char*>(block), size);
      while (!rest.empty()) {
        const ssize_t written = internal::uninterrupted(
            [&] { return ::pwrite(file, rest.data(), rest.size(), offset); });
        if (written < 0) fail_unpack(target);
        rest.remove_prefix(static_cast<std::size_t>(written));
        offset += written;
      }
    }
  }

  [[noreturn]] void fail(std::string_view entry, std::string_view expected) const {
    throw InvalidInput(fmt::format("{}: got the entry {}, expected {}", path_.string(),
                                   in_quotes(entry, 200), expected));
  }

 private:
  [[noreturn]] void refuse(const std::string& got, std::string_view expected) const {
    throw InvalidInput(fmt::format("{}: got {}, expected {}", path_.string(), got, expected));
  }

  void spend(std::uint64_t bytes) {
    if (bytes > left_)
      refuse(fmt::format("an archive that unpacks to more than {} times its size and 1 GiB",
                         kMostTimesLarger),
             "less");
    left_ -= bytes;
  }

  void check(int status) const {
    if (status >= ARCHIVE_WARN) return;
    const char* reason = archive_error_string(archive_.get());
    throw InvalidInput(fmt::format("{}: got an archive that cannot be read ({})", path_.string(),
                                   reason == nullptr ? "no reason given" : reason));
  }

  fs::path path_;
  std::uint64_t left_ = 0;  ///< bytes that may still come
  std::uint64_t end_ = 0;   ///< of the entry so far
  std::size_t entries_ = 0;
  std::unique_ptr<archive, decltype(&archive_read_free)> archive_;
};

/// The path below the target folder; empty for the stripped folder itself.
std::string inner_name(const Archive& archive, archive_entry* entry, const std::string& strip) {
  const char* raw = archive_entry_pathname_utf8(entry);
  const std::string full = raw == nullptr ? "" : raw;
  std::string name = full;
  while (name.starts_with("./")) name.erase(0, 2);
  while (name.ends_with('/')) name.pop_back();
  if (name.empty() || name == ".") return {};
  if (!is_inner_path(name)) archive.fail(full, "a path inside the folder");
  if (std::count(name.begin(), name.end(), '/') >= kDeepest)
    archive.fail(full, fmt::format("a path of at most {} names", kDeepest));
  if (strip.empty()) return name;
  if (name == strip) return {};
  return name.starts_with(strip + "/") ? name.substr(strip.size() + 1) : name;
}

/// Makes the folders that lead to `name`; none of them may be a link.
void make_folders(const Archive& archive, const fs::path& folder, const fs::path& name) {
  fs::path path = folder;
  for (const fs::path& part : name) {
    path /= part;
    std::error_code error;
    const fs::file_status status = fs::symlink_status(path, error);
    if (fs::is_symlink(status)) archive.fail(name.string(), "no symbolic link on its way");
    if (fs::is_directory(status)) continue;
    fs::create_directory(path, error);
    if (error)
      throw OutputError(fmt::format("{}: cannot be made: {}", path.string(), error.message()));
  }
}

void unpack_file(Archive& archive, const fs::path& folder, const fs::path& name) {
  make_folders(archive, folder, name.parent_path());
  const fs::path target = folder / name;
  const fs::path part = target.string() + ".part";
  std::error_code ignored;
  fs::remove(part, ignored);
  const int file = internal::uninterrupted([&] {
    return ::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  });
  if (file < 0) fail_unpack(part);
  try {
    archive.write_to(file, part);
  } catch (...) {
    ::close(file);
    fs::remove(part, ignored);
    throw;
  }
  if (::close(file) != 0 || std::rename(part.c_str(), target.c_str()) != 0) fail_unpack(target);
}

}  // namespace

bool is_archive_name(const std::string& name) {
  constexpr std::array<std::string_view, 6> kEnds{".zip", ".tar",    ".tar.gz",
                                                  ".tgz", ".tar.xz", ".tar.bz2"};
  return std::any_of(kEnds.begin(), kEnds.end(),
                     [&](std::string_view end) { return name.ends_with(end); });
}

std::optional<std::size_t> unpack_archive(const fs::path& path, const fs::path& folder,
                                          const std::string& strip,
                                          const UnpackProgress& progress) {
  Archive archive(path);
  std::size_t files = 0;
  while (archive_entry* entry = archive.next()) {
    const fs::path name = inner_name(archive, entry, strip);
    const auto type = archive_entry_filetype(entry);
    const bool is_file = type == AE_IFREG && archive_entry_hardlink(entry) == nullptr;
    if (!is_file && type != AE_IFDIR) archive.fail(name.string(), "files and folders, no links");
    if (name.empty()) continue;
    if (type == AE_IFDIR) {
      make_folders(archive, folder, name);
      continue;
    }
    unpack_file(archive, folder, name);
    ++files;
    if (progress && !progress(files)) return std::nullopt;
  }
  return files;
}

}  // namespace posemix
