// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <fmt/format.h>

#include "mat_file.hpp"
#include "posemix/base/error.hpp"

/// MatFile in a build without matio: the constructor throws.
namespace posemix::internal {

struct MatFile::Handle {};

MatFile::MatFile(const std::filesystem::path& path) {
  throw InvalidInput(
      fmt::format("{}: got a MATLAB file, expected another form: this build of "
                  "posemix is without matio",
                  path.string()));
}

MatFile::~MatFile() = default;

bool MatFile::has(const std::string&) const { return false; }

MatArray MatFile::array(const std::string&, std::size_t) const { return {}; }

void MatFile::fail(const std::string& name, const std::string& got,
                   const std::string& expected) const {
  throw InvalidInput(
      fmt::format("{}: variable '{}': got {}, expected {}", name_, name, got, expected));
}

std::string describe_dims(const std::vector<std::size_t>&) { return {}; }

}  // namespace posemix::internal
