// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "base/kept_memory.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <new>
#include <thread>
#include <vector>

#include "base/kept_matrices.hpp"

namespace posemix::internal {
namespace {

TEST(KeptMemory, IsAlignedAndOfItsOwn) {
  std::vector<std::pair<unsigned char*, std::size_t>> all;
  for (const std::size_t bytes :
       {0, 1, 63, 64, 65, 128, 129, 4096, 1 << 20, (1 << 20) + 1, 3 << 20}) {
    auto* const memory = static_cast<unsigned char*>(kept_memory(bytes));
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(memory) % kKeptAlignment, 0) << bytes;
    std::memset(memory, static_cast<int>(all.size()), bytes);
    all.emplace_back(memory, bytes);
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto [memory, bytes] = all[i];
    if (bytes > 0) EXPECT_EQ(memory[0], i);
    if (bytes > 0) EXPECT_EQ(memory[bytes - 1], i);
    keep_memory(memory, bytes);
  }
}

TEST(KeptMemory, IsGivenAgainForTheSameSize) {
  if (!kKeepsMemory) GTEST_SKIP() << "the address sanitizer watches memory that was given back";
  void* const first = kept_memory(1000);
  keep_memory(first, 1000);
  void* const other = kept_memory(5000);
  void* const again = kept_memory(1024);
  EXPECT_EQ(again, first);
  EXPECT_NE(other, first);
  keep_memory(again, 1024);
  keep_memory(other, 5000);
}

TEST(KeptMemory, OfNoSizeThatThereIsIsRefused) {
  for (const std::size_t less : {0, 1, 63, 64}) {
    EXPECT_THROW((void)kept_memory(std::numeric_limits<std::size_t>::max() - less), std::bad_alloc)
        << less;
  }
}

/// Takes and gives back sixteen megabytes, in pieces.
void fill() {
  std::vector<void*> pieces;
  for (int i = 0; i < 256; ++i) pieces.push_back(kept_memory(std::size_t{1} << 16));
  for (void* piece : pieces) keep_memory(piece, std::size_t{1} << 16);
}

TEST(KeptMemory, IsBoundedAndGivenBackWhenTheThreadEnds) {
  if (!kKeepsMemory) GTEST_SKIP() << "the address sanitizer watches memory that was given back";
  const auto held = [] {
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
  };
  const std::size_t before = held();
  std::size_t in_between = 0;
  std::thread([&] {
    fill();
    in_between = held();
  }).join();
  EXPECT_GT(in_between, before + kMostKeptMemory / 2);
  EXPECT_LT(in_between, before + kMostKeptMemory + kMostKeptMemory / 4);
  EXPECT_LT(held(), before + kMostKeptMemory / 4);
}

TEST(KeptMemory, MovesBetweenThreads) {
  KeptVector<std::vector<int>> made;
  std::thread([&] { made.assign(100, std::vector<int>{1, 2, 3}); }).join();
  EXPECT_EQ(made[99], (std::vector<int>{1, 2, 3}));
  std::thread([taken = std::move(made)]() mutable { taken.clear(); }).join();
}

TEST(KeptMatrix, IsZeroAtFirst) {
  for (int k = 0; k < 3; ++k) {
    KeptMatrix<> matrix(5, 7);
    EXPECT_EQ(matrix.get(), Eigen::MatrixXd::Zero(5, 7));
    matrix.get().setConstant(3.0);
    KeptMatrix<6> columns(4);
    EXPECT_EQ(columns.get(), Eigen::MatrixXd::Zero(4, 6));
    const KeptMatrix<> copy = matrix;
    matrix.get()(0, 0) = 1.0;
    EXPECT_EQ(copy.get()(0, 0), 3.0);
  }
}

}  // namespace
}  // namespace posemix::internal
