// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "base/kept_memory.hpp"

#include <array>
#include <bit>
#include <cstdlib>
#include <limits>
#include <new>

namespace posemix::internal {
namespace {

/// Pieces have 64, 128, 256, ... bytes; larger ones than the last are of the heap alone.
constexpr std::size_t kSizes = 15;

std::size_t index_of(std::size_t bytes) {
  return bytes <= kKeptAlignment
             ? 0
             : static_cast<std::size_t>(std::bit_width((bytes - 1) / kKeptAlignment));
}

constexpr std::size_t size_at(std::size_t index) { return kKeptAlignment << index; }

/// No array is larger [bytes].
constexpr std::size_t kLargest = std::numeric_limits<std::ptrdiff_t>::max() - kKeptAlignment;

/// A piece that is not used has the address of the next one in it.
struct Piece {
  Piece* next;
};

/// Has no destructor, so that it can be used as long as its thread runs.
struct Pieces {
  std::array<Piece*, kSizes> first = {};
  std::size_t bytes = 0;
  bool is_over = false;  ///< whether the thread ends
};

thread_local constinit Pieces pieces = {};

/// Frees what a thread kept when it ends.
struct AtEnd {
  AtEnd() = default;
  AtEnd(const AtEnd&) = delete;
  AtEnd& operator=(const AtEnd&) = delete;
  ~AtEnd() {
    pieces.is_over = true;
    for (Piece*& list : pieces.first) {
      while (list != nullptr) {
        Piece* const next = list->next;
        std::free(list);
        list = next;
      }
    }
  }
  /// Makes it, where that was not done before.
  void touch() const {}
};

thread_local const AtEnd at_end;

}  // namespace

void* kept_memory(std::size_t bytes) {
  const std::size_t index = index_of(bytes);
  if (index < kSizes && pieces.first[index] != nullptr) {
    Piece* const piece = pieces.first[index];
    pieces.first[index] = piece->next;
    pieces.bytes -= size_at(index);
    return piece;
  }
  if (bytes > kLargest) throw std::bad_alloc();
  const std::size_t size = index < kSizes
                               ? size_at(index)
                               : (bytes + kKeptAlignment - 1) / kKeptAlignment * kKeptAlignment;
  void* const memory = std::aligned_alloc(kKeptAlignment, size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void keep_memory(void* memory, std::size_t bytes) noexcept {
  const std::size_t index = index_of(bytes);
  if (!kKeepsMemory || index >= kSizes || pieces.is_over ||
      pieces.bytes + size_at(index) > kMostKeptMemory) {
    std::free(memory);
    return;
  }
  at_end.touch();
  pieces.bytes += size_at(index);
  pieces.first[index] = new (memory) Piece{pieces.first[index]};
}

}  // namespace posemix::internal
