// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>

#include "files.hpp"
#include "invariants.hpp"
#include "io/temporary_folder.hpp"
#include "posemix/io/npy.hpp"
#include "target.hpp"

/// Arrays of NumPy: what is read is written and read again alike, also from a file. After a 'd'
/// they are a file of any name in a folder of detections.
namespace posemix::fuzzing {
namespace {

void expect_same_array(const NpyArray& a, const NpyArray& b) {
  expect(a.shape == b.shape && a.values.size() == b.values.size(), "another shape after writing");
  expect(std::equal(a.values.begin(), a.values.end(), b.values.begin(),
                    [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); }),
         "other numbers after writing");
}

void read_detections(std::string_view bytes) {
  static const posemix::testing::TemporaryFolder folder;
  const NamedFile file(bytes);
  const auto path = folder.put(file.name, file.content);
  takes(folder.path().string(), [&] {
    for (const auto& [frame, pose] : read_npy_detections(folder.path(), "obj_")) {
      expect(frame > 0, "a frame before the first");
      expect_pose(pose);
    }
  });
  std::filesystem::remove(path);
}

void read_pose(std::string_view bytes) {
  takes("f.npy", [&] {
    const SE3d pose = parse_npy_pose(bytes, "f.npy");
    expect_pose(pose);
    expect(read_npy_pose(file_of(bytes)).matrix() == pose.matrix(), "another pose in the file");
  });
}

}  // namespace

POSEMIX_FUZZ_TARGET(npy) {
  if (bytes.starts_with('d')) return read_detections(bytes.substr(1));
  takes("f.npy", [&] {
    const NpyArray array = parse_npy_array(bytes, "f.npy");
    std::size_t size = 1;
    for (const std::size_t n : array.shape) size *= n;
    expect(size == array.values.size(), "a shape that is not that of the numbers");
    expect_same_array(parse_npy_array(format_npy(array), "again"), array);
  });
  read_pose(bytes);
}

}  // namespace posemix::fuzzing
