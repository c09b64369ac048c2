// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace posemix::internal {

/// An array of numbers in a MATLAB file.
struct MatArray {
  std::vector<std::size_t> dims;
  std::vector<double> values;  ///< column by column
};

/// A MATLAB file of version 5 (MATLAB's default without and with compression), of which arrays of
/// numbers are read. It asks for no more memory than the file has bytes and the caller's bounds
/// allow. Every member throws InvalidInput `file: variable 'name': got ..., expected ...`.
class MatFile {
 public:
  /// @throws InvalidInput when the file cannot be read, is none of version 5, or is cut off
  explicit MatFile(const std::filesystem::path& path);

  bool has(const std::string& name) const { return find(name) != nullptr; }
  /// The numbers of a variable, which must be real and finite, and not more than `most`.
  MatArray array(const std::string& name, std::size_t most) const;
  [[noreturn]] void fail(const std::string& name, const std::string& got,
                         const std::string& expected) const;

 private:
  struct Variable {
    std::string name;
    std::vector<std::size_t> dims;
    bool is_numeric = false;
    bool is_complex = false;
    bool is_compressed = false;
    std::string_view content;   ///< in bytes_, of the element that holds the variable
    std::size_t numbers_begin;  ///< first byte of the numbers' element in it, uncompressed
  };

  const Variable* find(const std::string& name) const;
  /// Lists the variable of a matrix of which `begin` are the first bytes.
  void list(std::string_view begin, std::string_view content, bool is_compressed);

  std::string name_;
  std::string bytes_;
  bool little_endian_ = true;
  std::vector<Variable> variables_;
};

/// Dimensions as text, such as "3x4x2".
std::string describe_dims(const std::vector<std::size_t>& dims);

}  // namespace posemix::internal
