// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/npy.hpp"

#include <algorithm>
#include <bit>
#include <concepts>
#include <cstring>
#include <limits>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "npy_header.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

using namespace internal;

constexpr std::string_view kExtension = ".npy";

template <std::floating_point Real, std::unsigned_integral Bits>
double entry_at(std::string_view data, std::size_t index) {
  Bits bits = 0;
  for (std::size_t byte = sizeof(Bits); byte-- > 0;) {
    const auto value = static_cast<unsigned char>(data[index * sizeof(Bits) + byte]);
    bits = static_cast<Bits>((bits << 8) | value);
  }
  return static_cast<double>(std::bit_cast<Real>(bits));
}

/// The index in C order of the entry that has `index` in Fortran order.
std::size_t place_in_c_order(std::size_t index, const std::vector<std::size_t>& shape) {
  std::size_t place = 0;
  std::size_t stride = 1;
  std::vector<std::size_t> indices(shape.size());
  for (std::size_t axis = 0; axis < shape.size(); ++axis) {
    indices[axis] = index % shape[axis];
    index /= shape[axis];
  }
  for (std::size_t axis = shape.size(); axis-- > 0;) {
    place += indices[axis] * stride;
    stride *= shape[axis];
  }
  return place;
}

/// The entries in C order.
std::vector<double> entries_of(std::string_view bytes, const NpyHeader& header,
                               const std::string& name) {
  const std::string_view data = bytes.substr(header.size);
  constexpr std::size_t kMost = std::numeric_limits<std::size_t>::max() / sizeof(double);
  std::size_t count = 1;
  for (const std::size_t length : header.shape) {
    count = length != 0 && count > kMost / length ? kMost : count * length;
  }
  const std::size_t expected = count * header.entry_size;
  if (data.size() != expected) {
    throw InvalidInput(fmt::format("{}: got {} bytes, expected {} ({} of header, {} of data)", name,
                                   bytes.size(), header.size + expected, header.size, expected));
  }
  std::vector<double> entries(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t place = header.fortran_order ? place_in_c_order(i, header.shape) : i;
    entries[place] = header.entry_size == 4 ? entry_at<float, std::uint32_t>(data, i)
                                            : entry_at<double, std::uint64_t>(data, i);
  }
  return entries;
}

std::vector<std::filesystem::path> files_of(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  std::filesystem::directory_iterator entry(folder, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    files.push_back(entry->path());
  }
  if (error) {
    throw InvalidInput(fmt::format("{}: cannot be read: {}", folder.string(), error.message()));
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::int64_t frame_number(const std::filesystem::path& path, std::size_t prefix_size) {
  const std::string file = path.filename().string();
  const std::string_view middle =
      std::string_view(file).substr(prefix_size, file.size() - prefix_size - kExtension.size());
  const bool digits =
      std::all_of(middle.begin(), middle.end(), [](char c) { return c >= '0' && c <= '9'; });
  const auto number = digits ? parse_integer(middle) : std::nullopt;
  if (!number || *number < 1) {
    throw InvalidInput(fmt::format("{}: got {} after the prefix, expected a frame number from 1",
                                   path.string(), in_quotes(middle)));
  }
  return *number;
}

}  // namespace

NpyArray parse_npy_array(std::string_view bytes, const std::string& name) {
  const NpyHeader header = parse_npy_header(bytes, name);
  return {header.shape, entries_of(bytes, header, name)};
}

std::string format_npy(const NpyArray& array) {
  std::string bytes = format_npy_header(array.shape);
  for (const double value : array.values) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (std::size_t byte = 0; byte < sizeof bits; ++byte) {
      bytes += static_cast<char>((bits >> (8 * byte)) & 0xff);
    }
  }
  return bytes;
}

Eigen::Matrix4d parse_npy_matrix(std::string_view bytes, const std::string& name) {
  const NpyHeader header = parse_npy_header(bytes, name);
  if (header.shape != std::vector<std::size_t>{4, 4}) {
    throw InvalidInput(
        fmt::format("{}: got the shape {}, expected (4, 4)", name, in_quotes(header.shape_text)));
  }
  const std::vector<double> entries = entries_of(bytes, header, name);
  return Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(entries.data());
}

SE3d parse_npy_pose(std::string_view bytes, const std::string& name, double tolerance) {
  return pose_from_matrix(parse_npy_matrix(bytes, name), name, tolerance);
}

SE3d read_npy_pose(const std::filesystem::path& path, double tolerance) {
  return parse_npy_pose(read_file(path), path.string(), tolerance);
}

std::map<std::int64_t, SE3d> read_npy_detections(const std::filesystem::path& folder,
                                                 const std::string& prefix, double tolerance) {
  std::map<std::int64_t, SE3d> poses;
  for (const std::filesystem::path& path : files_of(folder)) {
    const std::string file = path.filename().string();
    if (!file.starts_with(prefix) || !file.ends_with(kExtension)) continue;
    if (file.size() < prefix.size() + kExtension.size()) continue;
    const std::int64_t frame = frame_number(path, prefix.size());
    if (!poses.emplace(frame, read_npy_pose(path, tolerance)).second) {
      throw InvalidInput(
          fmt::format("{}: got frame {} again, expected one file per frame", path.string(), frame));
    }
  }
  if (poses.empty()) {
    throw InvalidInput(fmt::format("{}: got no file {}<number>.npy, expected at least one",
                                   folder.string(), prefix));
  }
  return poses;
}

}  // namespace posemix
