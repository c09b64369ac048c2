// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/results/state_file.hpp"

#include <fmt/format.h>

#include "io/input_files.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/output_file.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

/// What a function makes of the bytes of a file; its errors get the path.
template <class Read>
auto with_file(const std::filesystem::path& path, const Read& read) {
  const std::string bytes = internal::read_earlier_file(path);
  try {
    return read(bytes);
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", path.string(), error.what()));
  }
}

}  // namespace

void save_state(const std::filesystem::path& path, const MultiObjectSlam& slam) {
  write_output_file(path, state_bytes(slam));
}

void save_state(const std::filesystem::path& path, const StampedSlam& slam) {
  write_output_file(path, state_bytes(slam));
}

void save_state(const std::filesystem::path& path, const ObjectSlam& slam) {
  write_output_file(path, state_bytes(slam));
}

SlamState load_state(const std::filesystem::path& path) { return with_file(path, slam_of_state); }

StateInfo read_state_info(const std::filesystem::path& path) { return with_file(path, state_info); }

}  // namespace posemix
