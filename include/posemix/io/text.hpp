// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Strict reading of text files: numbers do not depend on the locale, and every error begins with
/// `file:line:`.
namespace posemix {

/// The bytes of a file.
/// @throws InvalidInput with the path and the system's reason when it cannot be read, and for files
/// above 1 GiB; std::system_error (std::errc::interrupted) when a signal's handler ends the wait
/// for a pipe
std::string read_file(const std::filesystem::path& path);

/// `text` in double quotes for a message: bytes outside printable ASCII are escaped, and a text
/// longer than `limit` characters is cut and ends in "...".
std::string in_quotes(std::string_view text, std::size_t limit = 40);

/// The finite decimal number that is the whole of `word` (a leading '+' is allowed). Empty for
/// other characters, for nan and inf, and if a double overflows or underflows.
std::optional<double> parse_number(std::string_view word);

/// The decimal integer that is the whole of `word`; empty otherwise.
std::optional<std::int64_t> parse_integer(std::string_view word);

/// The words of a line that are separated by blanks and tabs.
std::vector<std::string_view> split_words(std::string_view line);

/// The fields of a line between single `separator`s, empty ones included.
std::vector<std::string_view> split_fields(std::string_view line, char separator);

/// `text` without blanks and tabs at both ends.
std::string_view trimmed(std::string_view text);

/// Goes through the lines of a text and counts them.
///
/// Lines end in LF or CRLF; the last line need not have an end. A UTF-8 byte order mark at the
/// start is skipped.
class LineReader {
 public:
  /// `text` must outlive the reader; `name` is the name of the file in messages.
  /// @throws InvalidInput when the text contains a NUL byte, as binary files and UTF-16 do
  LineReader(std::string_view text, std::string name);

  /// Moves to the next line; false at the end of the text.
  bool next();
  /// Moves to the next line that is neither blank nor a comment that starts with '#'.
  bool next_content();

  /// The current line without its end.
  std::string_view line() const { return line_; }
  /// The number of the current line, counted from one.
  std::size_t number() const { return number_; }
  const std::string& name() const { return name_; }

  /// @throws InvalidInput `name:line: got <got>, expected <expected>`
  [[noreturn]] void fail(std::string_view got, std::string_view expected) const;

  /// The finite number in `word`; `column` is its name in the error.
  double number_from(std::string_view word, std::string_view column) const;
  /// The integer in `word`, which must not be negative; `column` is its name in the error.
  std::int64_t index_from(std::string_view word, std::string_view column) const;

 private:
  std::string_view rest_;
  std::string_view line_;
  std::string name_;
  std::size_t number_ = 0;
};

}  // namespace posemix
