// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "json_numbers.hpp"
#include "posemix/io/output_folder.hpp"

namespace posemix::internal {

/// Writes JSON key by key, with the bytes that json_text() gives for the whole document in one
/// line.
class JsonWriter {
 public:
  explicit JsonWriter(TextSink sink) : sink_(std::move(sink)) {}

  void begin_object() { open('{'); }
  void end_object() { close('}'); }
  void begin_array() { open('['); }
  void end_array() { close(']'); }
  void key(std::string_view name);
  void value(const Json& json);
  void entry(std::string_view name, const Json& json) {
    key(name);
    value(json);
  }
  /// The array of `size` values that `at` gives for the indices.
  template <class At>
  void array(std::string_view name, std::size_t size, const At& at) {
    key(name);
    begin_array();
    for (std::size_t i = 0; i < size; ++i) value(at(i));
    end_array();
  }
  /// A place for a text that is JSON already, such as the inside of an array.
  void raw(std::string_view text) { put(text); }
  /// Passes on what is left. At the end of the document a line end is due.
  void flush();

 private:
  void open(char bracket);
  void close(char bracket);
  void separate();
  void put(std::string_view text);

  TextSink sink_;
  std::string waiting_;
  std::vector<bool> has_items_;  ///< of the objects and arrays that are open
  bool after_key_ = false;
};

}  // namespace posemix::internal
