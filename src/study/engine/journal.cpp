// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "journal.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/checksum.hpp"
#include "base/uninterrupted.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/vector_instructions.hpp"
#include "posemix/io/output_folder.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kJournalSchema = 1;
constexpr const char* kInstructions = "instructions";
constexpr const char* kCheck = "crc64";

[[noreturn]] void fail_with_errno(const std::filesystem::path& path, std::string_view what) {
  throw OutputError(fmt::format("{}: {}: {}", path.string(), what, std::strerror(errno)));
}

/// Whether the path is still that of the open file, which another process may have removed.
bool is_at(const std::filesystem::path& path, int file) {
  struct stat named {};
  struct stat opened {};
  return ::stat(path.c_str(), &named) == 0 && ::fstat(file, &opened) == 0 &&
         named.st_dev == opened.st_dev && named.st_ino == opened.st_ino;
}

int open_locked(const std::filesystem::path& path) {
  while (true) {
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (file < 0 && errno == EINTR) continue;
    if (file < 0) fail_with_errno(path, "cannot be written");
    if (::flock(file, LOCK_EX | LOCK_NB) != 0) {
      const int reason = errno;
      ::close(file);
      if (reason == EWOULDBLOCK)
        throw OutputError(fmt::format("{}: in use by another process", path.string()));
      errno = reason;
      fail_with_errno(path, "cannot be locked");
    }
    if (is_at(path, file)) return file;
    ::close(file);
  }
}

Json head_of(const Study& study) {
  Json head;
  head["schema"] = kJournalSchema;
  head["study"] = study.name;
  head["items"] = study.items;
  head["settings"] = Json::parse(study.settings);
  return head;
}

std::string check_of(std::size_t item, std::string_view text) {
  return fmt::format("{:016x}", internal::crc64(fmt::format("{} {}", item, text)));
}

std::string line_of(const FinishedItem& item, bool is_checked) {
  const std::string check =
      is_checked ? fmt::format(",\"{}\":\"{}\"", kCheck, check_of(item.item, item.text)) : "";
  return fmt::format("{{\"item\":{},\"result\":{}{}}}\n", item.item, Json(item.text).dump(), check);
}

/// The item of a line; nothing where it is none of the study.
std::optional<FinishedItem> item_in(const Json& line, std::size_t items) {
  const bool valid = line.is_object() && line.contains("item") && line.contains("result") &&
                     line["item"].is_number_unsigned() && line["result"].is_string();
  if (!valid || line["item"].get<std::size_t>() >= items) return std::nullopt;
  return FinishedItem{line["item"].get<std::size_t>(), line["result"].get<std::string>()};
}

/// Whether a text begins as a journal does, as far as it goes.
bool is_journal(std::string_view text) {
  const std::string_view begin = "{\"schema\":1,\"study\":";
  const std::size_t size = std::min(text.size(), begin.size());
  return text.substr(0, size) == begin.substr(0, size);
}

/// Whether it is the head of a journal, or the beginning of one, without any item.
bool is_head_alone(std::string_view text) {
  return is_journal(text) && std::count(text.begin(), text.end(), '\n') <= 1;
}

/// The first key of two headers whose values differ, and both values.
std::string difference(const Json& theirs, const Json& ours, const std::string& path = {}) {
  if (!theirs.is_object() || !ours.is_object()) {
    return fmt::format("'{}' is {}, now {}", path, theirs.dump(), ours.dump());
  }
  for (const auto& [key, value] : ours.items()) {
    const Json other = theirs.value(key, Json());
    if (other == value) continue;
    return difference(other, value, path.empty() ? key : fmt::format("{}.{}", path, key));
  }
  return fmt::format("'{}' has other keys", path);
}

/// Refuses the journal of another study, or of results by other vector instructions.
void check_head(const std::filesystem::path& path, const Json& head, std::string_view instructions,
                const Study& study) {
  if (const Json ours = head_of(study); head != ours) {
    throw InvalidInput(fmt::format(
        "{}: the journal of another study: {}; write to another folder, or remove the file",
        path.string(), difference(head, ours)));
  }
  if (!instructions.empty() && instructions != vector_instructions()) {
    throw InvalidInput(fmt::format(
        "{}: its results are by other vector instructions, {}, now {}, and the last bits would "
        "differ from item to item; continue where `posemix --version` says {} (POSEMIX_SIMD "
        "chooses), or remove the file",
        path.string(), instructions, vector_instructions(), instructions));
  }
}

}  // namespace

Journal::Journal(std::filesystem::path path, const Study& study, bool resume)
    : path_(std::move(path)), file_(open_locked(path_)) {
  try {
    read(study, resume);
  } catch (...) {
    ::close(file_);
    throw;
  }
}

Journal::~Journal() {
  if (!holds_items_) ::unlink(path_.c_str());
  ::close(file_);
}

void Journal::read(const Study& study, bool resume) {
  std::string text = read_file(path_);
  const bool is_new = is_head_alone(text);
  if (!is_journal(text)) {
    throw InvalidInput(fmt::format(
        "{}:1: got {}, expected the head of a study's journal: another file has its name, write to "
        "another folder",
        path_.string(), in_quotes(std::string_view(text).substr(0, text.find('\n')))));
  }
  if (!is_new && !resume) {
    throw InvalidInput(fmt::format(
        "{}: the journal of an interrupted study; continue it with --resume, or remove the file",
        path_.string()));
  }
  // A line that was cut off is none, and a head alone is as good as no journal.
  text.resize(is_new ? 0 : text.rfind('\n') + 1);
  cut_to(text.size());
  if (is_new) return write_head(study);
  LineReader lines(text, path_.string());
  read_head(lines, study);
  while (lines.next()) read_item(lines, study);
  holds_items_ = !finished_.empty();
}

void Journal::read_item(LineReader& lines, const Study& study) {
  const Json line = Json::parse(lines.line(), nullptr, false);
  auto item = item_in(line, study.items);
  if (!item) lines.fail(in_quotes(lines.line()), "a finished item of the study");
  const auto check = line.find(kCheck);
  if (is_checked_ ? check == line.end() || *check != check_of(item->item, item->text)
                  : check != line.end()) {
    lines.fail(in_quotes(lines.line()),
               "an item as it was written: without this line the item is done again");
  }
  finished_[item->item] = std::move(item->text);
}

/// Makes the file as long as its whole lines.
void Journal::cut_to(std::size_t size) {
  if (internal::uninterrupted([&] { return ::ftruncate(file_, static_cast<off_t>(size)); }) != 0)
    fail_with_errno(path_, "cannot be written");
  size_ = size;
}

void Journal::write_head(const Study& study) {
  instructions_ = vector_instructions();
  Json head = head_of(study);
  head[kInstructions] = instructions_;
  head[kCheck] = is_checked_;
  write(head.dump() + "\n");
}

void Journal::read_head(LineReader& lines, const Study& study) {
  lines.next();
  Json head = Json::parse(lines.line(), nullptr, false);
  if (!head.is_object()) lines.fail(in_quotes(lines.line()), "the head of a study's journal");
  if (head.contains(kInstructions)) {
    const Json& instructions = head[kInstructions];
    if (!instructions.is_string()) lines.fail(instructions.dump(), "vector instructions as a text");
    instructions_ = instructions.get<std::string>();
    head.erase(kInstructions);
  }
  is_checked_ = head.value(kCheck, Json()) == true;
  head.erase(kCheck);
  check_head(path_, head, instructions_, study);
}

void Journal::append(std::span<const FinishedItem> items) {
  if (items.empty()) return;
  std::string lines;
  for (const FinishedItem& item : items) lines += line_of(item, is_checked_);
  write(lines);
  holds_items_ = true;
}

void Journal::write(std::string_view lines) {
  const std::size_t size = size_ + lines.size();
  while (!lines.empty()) {
    const ssize_t written = ::write(file_, lines.data(), lines.size());
    if (written < 0 && errno != EINTR) fail_to_write();
    if (written > 0) lines.remove_prefix(static_cast<std::size_t>(written));
  }
  size_ = size;
}

/// What comes next begins on a line of its own, if anything can come.
void Journal::fail_to_write() {
  const int reason = errno;
  cut_to(size_);
  errno = reason;
  fail_with_errno(path_, "cannot be written");
}

}  // namespace posemix
