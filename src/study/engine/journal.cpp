// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "journal.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "posemix/base/error.hpp"
#include "posemix/base/vector_instructions.hpp"
#include "posemix/io/output_folder.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kJournalSchema = 1;
constexpr const char* kInstructions = "instructions";

[[noreturn]] void fail_with_errno(const std::filesystem::path& path, std::string_view what) {
  throw OutputError(fmt::format("{}: {}: {}", path.string(), what, std::strerror(errno)));
}

int open_locked(const std::filesystem::path& path, bool resume) {
  const int flags = O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | (resume ? 0 : O_EXCL);
  const int file = ::open(path.c_str(), flags, 0666);
  if (file < 0 && errno == EEXIST) {
    throw InvalidInput(fmt::format(
        "{}: the journal of an interrupted study; continue it with --resume, or remove the file",
        path.string()));
  }
  if (file < 0) fail_with_errno(path, "cannot be written");
  if (::flock(file, LOCK_EX | LOCK_NB) != 0) {
    ::close(file);
    throw OutputError(fmt::format("{}: in use by another process", path.string()));
  }
  return file;
}

Json head_of(const Study& study) {
  Json head;
  head["schema"] = kJournalSchema;
  head["study"] = study.name;
  head["items"] = study.items;
  head["settings"] = Json::parse(study.settings);
  return head;
}

std::string line_of(const FinishedItem& item) {
  return fmt::format("{{\"item\":{},\"result\":{}}}\n", item.item, Json(item.text).dump());
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
    : path_(std::move(path)), file_(open_locked(path_, resume)) {
  try {
    read(study);
  } catch (...) {
    ::close(file_);
    throw;
  }
}

Journal::~Journal() {
  if (!holds_items_) ::unlink(path_.c_str());
  ::close(file_);
}

void Journal::read(const Study& study) {
  const std::string text = read_file(path_);
  const std::size_t whole = text.rfind('\n') + 1;  // 0 where there is no line
  if (::ftruncate(file_, static_cast<off_t>(whole)) != 0) {
    fail_with_errno(path_, "cannot be written");
  }
  if (whole == 0) return write_head(study);
  LineReader lines(std::string_view(text).substr(0, whole), path_.string());
  read_head(lines, study);
  while (lines.next()) {
    const Json line = Json::parse(lines.line(), nullptr, false);
    const bool valid = line.is_object() && line.contains("item") && line.contains("result") &&
                       line["item"].is_number_unsigned() && line["result"].is_string();
    if (!valid || line["item"].get<std::size_t>() >= study.items) {
      lines.fail(in_quotes(lines.line()), "a finished item of the study");
    }
    finished_[line["item"].get<std::size_t>()] = line["result"].get<std::string>();
  }
  holds_items_ = !finished_.empty();
}

void Journal::write_head(const Study& study) {
  instructions_ = vector_instructions();
  Json head = head_of(study);
  head[kInstructions] = instructions_;
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
  check_head(path_, head, instructions_, study);
}

void Journal::append(std::span<const FinishedItem> items) {
  if (items.empty()) return;
  std::string lines;
  for (const FinishedItem& item : items) lines += line_of(item);
  write(lines);
  holds_items_ = true;
}

void Journal::write(std::string_view line) {
  while (!line.empty()) {
    const ssize_t written = ::write(file_, line.data(), line.size());
    if (written < 0 && errno != EINTR) fail_with_errno(path_, "cannot be written");
    if (written > 0) line.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace posemix
