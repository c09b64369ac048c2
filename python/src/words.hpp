// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <nanobind/nanobind.h>

#include "posemix/base/words.hpp"

namespace posemix::python {

/// An enum whose members are named by the words that files have.
template <Spelled Enum>
class Words {
 public:
  Words(nanobind::module_& m, const char* name, const char* doc) : enum_(m, name, doc) {}

  Words& value(Enum value, const char* doc) {
    enum_.value(word_of(value).data(), value,
                doc);  // the words are literals, which end with a null
    return *this;
  }

 private:
  nanobind::enum_<Enum> enum_;
};

}  // namespace posemix::python
