// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/fiducial/tag_file.hpp"

namespace posemix {

std::optional<double> TagMap::size_of(std::int64_t tag) const {
  const auto own = size_m.find(tag);
  return own == size_m.end() ? default_size_m : std::optional(own->second);
}

}  // namespace posemix
