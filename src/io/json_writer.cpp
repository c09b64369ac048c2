// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "json_writer.hpp"

namespace posemix::internal {
namespace {

constexpr std::size_t kJsonPiece = std::size_t{1} << 16U;

std::string json_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

void JsonWriter::key(std::string_view name) {
  separate();
  put(json_line(Json(name)));
  put(":");
  after_key_ = true;
}

void JsonWriter::value(const Json& json) {
  separate();
  put(json_line(json));
}

void JsonWriter::open(char bracket) {
  separate();
  put({&bracket, 1});
  has_items_.push_back(false);
}

void JsonWriter::close(char bracket) {
  put({&bracket, 1});
  has_items_.pop_back();
}

void JsonWriter::separate() {
  if (after_key_) {
    after_key_ = false;
    return;
  }
  if (has_items_.empty()) return;
  if (has_items_.back()) put(",");
  has_items_.back() = true;
}

void JsonWriter::put(std::string_view text) {
  waiting_ += text;
  if (waiting_.size() >= kJsonPiece) flush();
}

void JsonWriter::flush() {
  sink_(waiting_);
  waiting_.clear();
}

}  // namespace posemix::internal
