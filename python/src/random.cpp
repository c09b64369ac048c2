// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/base/random.hpp"

#include <array>
#include <bit>
#include <cstdint>

#include <nanobind/stl/array.h>

#include "arrays.hpp"

namespace posemix::python {

constexpr const char* kStreamDoc =
    R"(A stream of random numbers, Philox 4x32 by a counter.

Parameters
----------
seed : int
    Seed of the generator.
stream : int
    Number of the stream: different streams of one seed are independent.

Examples
--------
>>> from posemix import RandomStream
>>> float(RandomStream(1).uniform(1)[0]) == float(RandomStream(1).uniform(1)[0])
True
)";

void bind_random(nb::module_& m) {
  using State = std::array<std::uint32_t, sizeof(RandomStream) / sizeof(std::uint32_t)>;
  nb::class_<RandomStream>(m, "RandomStream", kStreamDoc)
      .def(nb::init<std::uint64_t, std::uint64_t>(), "seed"_a, "stream"_a = 0)
      .def(
          "uniform",
          [](RandomStream& self, std::size_t count) {
            NewArray result({count});
            for (std::size_t i = 0; i < count; ++i) result.data[i] = self.uniform();
            return result.array;
          },
          "count"_a, "Uniform deviates in [0, 1), shape (count,).")
      .def(
          "normal",
          [](RandomStream& self, std::size_t count) {
            NewArray result({count});
            for (std::size_t i = 0; i < count; ++i) result.data[i] = self.normal();
            return result.array;
          },
          "count"_a, "Standard normal deviates, shape (count,).")
      .def("__getstate__", [](const RandomStream& self) { return std::bit_cast<State>(self); })
      .def("__setstate__", [](RandomStream& self, const State& state) {
        new (&self) RandomStream(std::bit_cast<RandomStream>(state));
      });
}

}  // namespace posemix::python
