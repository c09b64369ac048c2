// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <new>
#include <vector>

/// Memory that a thread keeps for the next frame of a filter, which thus asks the heap for nothing
/// once its sizes have been seen.
namespace posemix::internal {

/// False under the address sanitizer, which notices the use of memory that was given back.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kKeepsMemory = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr bool kKeepsMemory = false;
#else
inline constexpr bool kKeepsMemory = true;
#endif
#else
inline constexpr bool kKeepsMemory = true;
#endif

/// Alignment of what kept_memory() gives [bytes].
inline constexpr std::size_t kKeptAlignment = 64;

/// What one thread keeps at most [bytes]; beyond that memory goes back to the heap.
inline constexpr std::size_t kMostKeptMemory = std::size_t{4} << 20;

/// @throws std::bad_alloc
void* kept_memory(std::size_t bytes);
/// Takes in memory of kept_memory(), which was asked for with the same size, by any thread.
void keep_memory(void* memory, std::size_t bytes) noexcept;

/// Gives the elements of a container kept memory.
template <class T>
struct KeptAllocator {
  using value_type = T;

  KeptAllocator() = default;
  template <class U>
  KeptAllocator(const KeptAllocator<U>&) noexcept {}  // NOLINT(google-explicit-constructor)

  T* allocate(std::size_t count) {
    static_assert(alignof(T) <= kKeptAlignment);
    if (count > static_cast<std::size_t>(-1) / sizeof(T)) throw std::bad_array_new_length();
    return static_cast<T*>(kept_memory(count * sizeof(T)));
  }
  void deallocate(T* first, std::size_t count) noexcept {
    keep_memory(static_cast<void*>(first), count * sizeof(T));
  }

  template <class U>
  bool operator==(const KeptAllocator<U>&) const noexcept {
    return true;
  }
};

template <class T>
using KeptVector = std::vector<T, KeptAllocator<T>>;

}  // namespace posemix::internal
