// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "unnamed_file.hpp"

#include <cerrno>

#include <fcntl.h>
#include <unistd.h>

#include <fmt/format.h>

#include "descriptor.hpp"

namespace posemix::internal {
namespace {

constexpr std::size_t kTextPiece = std::size_t{1} << 16U;

/// A new file in the folder, already without a name.
int open_in(const std::filesystem::path& folder) {
  const int unnamed = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (unnamed >= 0) return unnamed;
  // A file system that does not know files without a name.
  std::string path = (folder / fmt::format(".posemix-{}-XXXXXX", ::getpid())).string();
  const int named = ::mkostemp(path.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(path.c_str());
  return named;
}

}  // namespace

UnnamedFile::UnnamedFile(std::filesystem::path folder)
    : folder_(std::move(folder)), number_(open_in(folder_)) {
  if (number_ < 0) fail_with_errno(folder_, "a temporary file cannot be created");
}

UnnamedFile::~UnnamedFile() { ::close(number_); }

std::uint64_t UnnamedFile::append(std::string_view bytes) {
  const std::uint64_t place = size_;
  while (!bytes.empty()) {
    const ssize_t written =
        ::pwrite(number_, bytes.data(), bytes.size(), static_cast<off_t>(size_));
    if (written < 0 && errno != EINTR) {
      fail_with_errno(folder_, "a temporary file cannot be written");
    }
    if (written <= 0) continue;
    size_ += static_cast<std::uint64_t>(written);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return place;
}

void UnnamedFile::read(std::uint64_t place, char* bytes, std::size_t size) const {
  while (size > 0) {
    const ssize_t got = ::pread(number_, bytes, size, static_cast<off_t>(place));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) fail_with_errno(folder_, "a temporary file cannot be read");
    bytes += got;
    place += static_cast<std::uint64_t>(got);
    size -= static_cast<std::size_t>(got);
  }
}

void GrowingTexts::append(std::size_t text, std::string_view more) {
  Text& grown = texts_[text];
  grown.end += more;
  if (grown.end.size() < kTextPiece) return;
  grown.pieces.push_back({file_.append(grown.end), grown.end.size()});
  grown.end.clear();
}

void GrowingTexts::copy(std::size_t text, const TextSink& sink) const {
  std::string bytes;
  for (const Piece& piece : texts_[text].pieces) {
    bytes.resize(piece.size);
    file_.read(piece.place, bytes.data(), bytes.size());
    sink(bytes);
  }
  sink(texts_[text].end);
}

}  // namespace posemix::internal
