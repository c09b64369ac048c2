// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>

#include <nanobind/nanobind.h>

#include "posemix/base/random.hpp"

namespace posemix::python {

/// A seed, whose first stream is meant, or a stream that goes on.
class Seed {
 public:
  Seed() = default;
  explicit Seed(std::uint64_t seed) : own_(RandomStream(seed, 0)) {}
  explicit Seed(RandomStream& stream) : given_(&stream) {}

  RandomStream& stream() const { return given_ != nullptr ? *given_ : *own_; }

 private:
  RandomStream* given_ = nullptr;
  mutable std::optional<RandomStream> own_;
};

}  // namespace posemix::python

namespace nanobind::detail {

template <>
struct type_caster<posemix::python::Seed> {
  NB_TYPE_CASTER(posemix::python::Seed, const_name("int | RandomStream"))

  bool from_python(handle source, std::uint8_t flags, cleanup_list* cleanup) noexcept {
    if (isinstance<posemix::RandomStream>(source)) {
      value = posemix::python::Seed(*inst_ptr<posemix::RandomStream>(source));
      return true;
    }
    make_caster<std::uint64_t> number;
    if (!number.from_python(source, flags, cleanup)) return false;
    value = posemix::python::Seed(number.value);
    return true;
  }
};

}  // namespace nanobind::detail
