// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>

#include "invariants.hpp"
#include "posemix/io/npy.hpp"
#include "target.hpp"

/// Arrays of NumPy: what is read is written and read again alike.
namespace posemix::fuzzing {
namespace {

void expect_same_array(const NpyArray& a, const NpyArray& b) {
  expect(a.shape == b.shape && a.values.size() == b.values.size(), "another shape after writing");
  expect(std::equal(a.values.begin(), a.values.end(), b.values.begin(),
                    [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); }),
         "other numbers after writing");
}

}  // namespace

POSEMIX_FUZZ_TARGET(npy) {
  takes("f.npy", [&] {
    const NpyArray array = parse_npy_array(bytes, "f.npy");
    std::size_t size = 1;
    for (const std::size_t n : array.shape) size *= n;
    expect(size == array.values.size(), "a shape that is not that of the numbers");
    expect_same_array(parse_npy_array(format_npy(array), "again"), array);
  });
  takes("f.npy", [&] { expect_pose(parse_npy_pose(bytes, "f.npy")); });
}

}  // namespace posemix::fuzzing
