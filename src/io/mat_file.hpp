// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace posemix::internal {

/// An array of numbers in a MATLAB file.
struct MatArray {
  std::vector<std::size_t> dims;
  std::vector<double> values;  ///< column by column
};

/// A MATLAB file of version 5 (MATLAB's default without and with compression). Every member throws
/// InvalidInput `file: variable 'name': got ..., expected ...`.
class MatFile {
 public:
  explicit MatFile(const std::filesystem::path& path);
  ~MatFile();
  MatFile(const MatFile&) = delete;
  MatFile& operator=(const MatFile&) = delete;

  bool has(const std::string& name) const;
  /// The numbers of a variable, which must be real and finite, and not more than `most`.
  MatArray array(const std::string& name, std::size_t most) const;
  [[noreturn]] void fail(const std::string& name, const std::string& got,
                         const std::string& expected) const;

 private:
  struct Handle;
  std::string name_;
  std::unique_ptr<Handle> handle_;
};

/// Dimensions as text, such as "3x4x2".
std::string describe_dims(const std::vector<std::size_t>& dims);

}  // namespace posemix::internal
