// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/io/output_folder.hpp"

namespace posemix::internal {

/// A temporary file without a name: it is gone with the process, however that ends. Every member
/// throws OutputError.
class UnnamedFile {
 public:
  /// `folder` decides on the disk.
  explicit UnnamedFile(std::filesystem::path folder);
  ~UnnamedFile();
  UnnamedFile(const UnnamedFile&) = delete;
  UnnamedFile& operator=(const UnnamedFile&) = delete;

  /// Writes at the end and returns the place.
  std::uint64_t append(std::string_view bytes);
  void read(std::uint64_t place, char* bytes, std::size_t size) const;

 private:
  std::filesystem::path folder_;
  int number_;
  std::uint64_t size_ = 0;
};

/// Texts that grow side by side and together are larger than memory should be.
class GrowingTexts {
 public:
  GrowingTexts(const std::filesystem::path& folder, std::size_t count)
      : file_(folder), texts_(count) {}

  void append(std::size_t text, std::string_view more);
  /// Passes on a text, piece by piece.
  void copy(std::size_t text, const TextSink& sink) const;

 private:
  struct Piece {
    std::uint64_t place;
    std::size_t size;
  };
  struct Text {
    std::vector<Piece> pieces;  ///< in the file
    std::string end;            ///< in memory
  };

  UnnamedFile file_;
  std::vector<Text> texts_;
};

}  // namespace posemix::internal
