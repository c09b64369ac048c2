// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "io/mat_file.hpp"

#include <bit>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <matio.h>

#include "expect_invalid.hpp"
#include "temporary_folder.hpp"

namespace posemix::internal {
namespace {

constexpr std::size_t kMost = 1000;

// Codes of the format.
constexpr std::uint32_t kUint8Type = 2;
constexpr std::uint32_t kDoubleType = 9;
constexpr std::uint32_t kMatrixType = 14;
constexpr std::uint32_t kCharClass = 4;
constexpr std::uint32_t kDoubleClass = 6;
constexpr std::uint32_t kComplexFlag = 0x800;

/// A file of version 5, made by hand from the description of the format.
struct HandMade {
  bool little_endian = true;

  template <typename Word>
  std::string bytes(Word word) const {
    std::string text;
    for (std::size_t i = 0; i < sizeof(Word); ++i) {
      const std::size_t shift = 8 * (little_endian ? i : sizeof(Word) - 1 - i);
      text += static_cast<char>((word >> shift) & 0xffU);
    }
    return text;
  }
  std::string element(std::uint32_t type, const std::string& data) const {
    return bytes(type) + bytes(static_cast<std::uint32_t>(data.size())) + data +
           std::string((8 - data.size() % 8) % 8, '\0');
  }
  /// Numbers of one byte within the tag of their element.
  std::string small(std::string data) const {
    const auto size = static_cast<std::uint32_t>(data.size());
    data.resize(4, '\0');
    return bytes(size << 16 | kUint8Type) + data;
  }
  std::string doubles(const std::vector<double>& numbers) const {
    std::string data;
    for (const double number : numbers) data += bytes(std::bit_cast<std::uint64_t>(number));
    return element(kDoubleType, data);
  }
  /// A variable `x`.
  std::string variable(std::uint32_t flags, const std::vector<std::uint32_t>& dims,
                       const std::string& numbers) const {
    std::string lengths;
    for (const std::uint32_t dim : dims) lengths += bytes(dim);
    return element(kMatrixType, element(6, bytes(flags) + bytes(std::uint32_t{0})) +
                                    element(5, lengths) + element(1, "x") + numbers);
  }
  std::string file(const std::string& elements) const {
    return std::string(124, ' ') + std::string(little_endian ? "\0\1IM" : "\1\0MI", 4) + elements;
  }
};

class MatFileTest : public ::testing::Test {
 protected:
  MatFile file_of(const std::string& bytes) const { return MatFile(folder_.put("a.mat", bytes)); }
  std::vector<double> values_of(const std::string& bytes) const {
    return file_of(bytes).array("x", kMost).values;
  }
  std::string error_of(const std::string& bytes) const {
    return testing::invalid_input_message([&] { values_of(bytes); });
  }
  /// What matio writes: the numbers 0, 1, ... as one of its classes.
  template <typename Number>
  std::string written(matio_classes kind, matio_types type, std::vector<std::size_t> dims,
                      bool compressed) const {
    std::size_t count = 1;
    for (const std::size_t dim : dims) count *= dim;
    std::vector<Number> numbers(count);
    for (std::size_t i = 0; i < count; ++i) numbers[i] = static_cast<Number>(i);
    const auto path = folder_ / "written.mat";
    mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
    for (const char* name : {"before", "x"}) {
      matvar_t* entry = Mat_VarCreate(name, kind, type, static_cast<int>(dims.size()), dims.data(),
                                      numbers.data(), 0);
      Mat_VarWrite(file, entry, compressed ? MAT_COMPRESSION_ZLIB : MAT_COMPRESSION_NONE);
      Mat_VarFree(entry);
    }
    Mat_Close(file);
    return testing::content_of(path);
  }
  template <typename Number>
  void expect_reads(matio_classes kind, matio_types type) const {
    for (const bool compressed : {false, true}) {
      const MatArray array =
          file_of(written<Number>(kind, type, {3, 4, 2}, compressed)).array("x", 24);
      EXPECT_EQ(array.dims, (std::vector<std::size_t>{3, 4, 2}));
      ASSERT_EQ(array.values.size(), 24U);
      for (std::size_t i = 0; i < 24; ++i) EXPECT_EQ(array.values[i], static_cast<double>(i));
    }
  }

  testing::TemporaryFolder folder_;
};

TEST_F(MatFileTest, EveryTypeOfNumberThatMatioWrites) {
  expect_reads<double>(MAT_C_DOUBLE, MAT_T_DOUBLE);
  expect_reads<float>(MAT_C_SINGLE, MAT_T_SINGLE);
  expect_reads<std::int8_t>(MAT_C_INT8, MAT_T_INT8);
  expect_reads<std::uint8_t>(MAT_C_UINT8, MAT_T_UINT8);
  expect_reads<std::int16_t>(MAT_C_INT16, MAT_T_INT16);
  expect_reads<std::uint16_t>(MAT_C_UINT16, MAT_T_UINT16);
  expect_reads<std::int32_t>(MAT_C_INT32, MAT_T_INT32);
  expect_reads<std::uint32_t>(MAT_C_UINT32, MAT_T_UINT32);
  expect_reads<std::int64_t>(MAT_C_INT64, MAT_T_INT64);
  expect_reads<std::uint64_t>(MAT_C_UINT64, MAT_T_UINT64);
}

TEST_F(MatFileTest, BothOrdersOfBytes) {
  for (const bool little_endian : {true, false}) {
    const HandMade hand{little_endian};
    const std::vector<double> numbers{1.5, -2.0, 3e-7};
    EXPECT_EQ(values_of(hand.file(hand.variable(kDoubleClass, {3, 1}, hand.doubles(numbers)))),
              numbers);
  }
}

/// MATLAB stores doubles that are small integers in fewer bytes, down to within the tag.
TEST_F(MatFileTest, NumbersInASmallerTypeThanTheirClass) {
  for (const bool little_endian : {true, false}) {
    const HandMade hand{little_endian};
    EXPECT_EQ(values_of(hand.file(hand.variable(kDoubleClass, {1, 3}, hand.small("\1\2\377")))),
              (std::vector<double>{1.0, 2.0, 255.0}));
  }
}

TEST_F(MatFileTest, AnEmptyArrayHasNoNumbers) {
  const HandMade hand;
  EXPECT_TRUE(values_of(hand.file(hand.variable(kDoubleClass, {0, 0}, hand.doubles({})))).empty());
}

TEST_F(MatFileTest, OnlyRealFiniteNumbersAreTaken) {
  const HandMade hand;
  const std::string one = hand.doubles({1.0});
  EXPECT_TRUE(error_of(hand.file(hand.variable(kCharClass, {1, 1}, one)))
                  .ends_with("a.mat: variable 'x': got something else, expected an array of "
                             "numbers"));
  EXPECT_NE(error_of(hand.file(hand.variable(kDoubleClass | kComplexFlag, {1, 1}, one + one)))
                .find("got complex numbers, expected real ones"),
            std::string::npos);
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_NE(error_of(hand.file(hand.variable(kDoubleClass, {1, 1}, hand.doubles({infinity}))))
                .find("got the number inf, expected finite ones"),
            std::string::npos);
  EXPECT_NE(error_of(hand.file("")).find("variable 'x': got none"), std::string::npos);
}

TEST_F(MatFileTest, MoreNumbersThanAskedForAreNotRead) {
  const HandMade hand;
  const std::string one = hand.doubles({1.0});
  const std::uint32_t large = std::uint32_t{1} << 30;
  for (const auto& dims : std::vector<std::vector<std::uint32_t>>{
           {1001, 1}, {large, large, large}, {0, large}, {100, 11}}) {
    EXPECT_NE(error_of(hand.file(hand.variable(kDoubleClass, dims, one)))
                  .find("numbers, expected at most 1000"),
              std::string::npos);
  }
  EXPECT_NE(error_of(hand.file(hand.variable(kDoubleClass, {2, 1}, one))).find("got damaged data"),
            std::string::npos);
}

/// A file that ends anywhere is refused, or the variable was whole before.
TEST_F(MatFileTest, AFileThatIsCutOffIsRefused) {
  for (const bool compressed : {false, true}) {
    const std::string whole = written<double>(MAT_C_DOUBLE, MAT_T_DOUBLE, {3, 4}, compressed);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const std::string error = error_of(whole.substr(0, size));
      if (size < 128) {
        EXPECT_NE(error.find("got no MATLAB file of version 5"), std::string::npos) << size;
      } else if (error.find("variable 'x': got none") == std::string::npos) {
        EXPECT_NE(error.find("got a file that is cut off"), std::string::npos) << size;
      }
    }
  }
}

/// Every bit of a compressed variable counts: zlib has a checksum.
TEST_F(MatFileTest, DamageInACompressedVariableIsFound) {
  const std::string whole = written<double>(MAT_C_DOUBLE, MAT_T_DOUBLE, {3, 4}, true);
  const std::vector<double> values = values_of(whole);
  std::size_t refused = 0;
  for (std::size_t at = 128; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    try {
      EXPECT_EQ(values_of(damaged), values) << at;
    } catch (const InvalidInput&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, (whole.size() - 128) / 2);
}

TEST_F(MatFileTest, AHugeSizeOfAnElementAsksForNoMemory) {
  const HandMade hand;
  std::string bytes = hand.variable(kDoubleClass, {1, 1}, hand.doubles({1.0}));
  const std::string huge = hand.bytes(std::uint32_t{0xfffffff0});
  EXPECT_NE(error_of(hand.file(std::string(bytes).replace(4, 4, huge))).find("cut off"),
            std::string::npos);
  // The name of the variable; then there is no variable of that name.
  EXPECT_NE(error_of(hand.file(std::string(bytes).replace(44, 4, huge))).find("got none"),
            std::string::npos);
}

}  // namespace
}  // namespace posemix::internal
