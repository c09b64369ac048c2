// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "messages.hpp"

#include <cstdint>
#include <cstring>
#include <stdexcept>

namespace posemix {
namespace {

template <class Number>
void put(std::string& message, Number number) {
  char bytes[sizeof number];
  std::memcpy(bytes, &number, sizeof number);
  message.append(bytes, sizeof number);
}

std::string_view take_bytes(std::string_view& message, std::size_t count) {
  if (count > message.size()) throw std::runtime_error("a message between ranks is cut off");
  const std::string_view bytes = message.substr(0, count);
  message.remove_prefix(count);
  return bytes;
}

template <class Number>
Number take(std::string_view& message) {
  Number number;
  std::memcpy(&number, take_bytes(message, sizeof number).data(), sizeof number);
  return number;
}

}  // namespace

std::string ranges_message(std::span<const ItemRange> ranges) {
  std::string message;
  for (const ItemRange& range : ranges) {
    put<std::uint64_t>(message, range.first);
    put<std::uint64_t>(message, range.count);
  }
  return message;
}

std::vector<ItemRange> ranges_in(std::string_view message) {
  std::vector<ItemRange> ranges;
  while (!message.empty()) {
    ItemRange& range = ranges.emplace_back();
    range.first = take<std::uint64_t>(message);
    range.count = take<std::uint64_t>(message);
  }
  return ranges;
}

std::string results_message(std::span<const FinishedItem> items, double seconds) {
  std::string message;
  put(message, seconds);
  for (const FinishedItem& item : items) {
    put<std::uint64_t>(message, item.item);
    put<std::uint64_t>(message, item.text.size());
    message += item.text;
  }
  return message;
}

FinishedBatch results_in(std::string_view message) {
  FinishedBatch batch;
  batch.seconds = take<double>(message);
  while (!message.empty()) {
    FinishedItem& item = batch.items.emplace_back();
    item.item = take<std::uint64_t>(message);
    item.text = take_bytes(message, take<std::uint64_t>(message));
  }
  return batch;
}

}  // namespace posemix
