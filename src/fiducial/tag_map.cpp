// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/fiducial/tag_file.hpp"

namespace posemix {

std::optional<double> TagMap::size_of(std::int64_t tag) const {
  const auto own = size_m.find(tag);
  return own == size_m.end() ? default_size_m : std::optional(own->second);
}

std::int64_t TagMap::tag_at(std::int64_t id, double stamp_s) const {
  for (const TagRemap& remap : remaps) {
    if (remap.id == id && stamp_s >= remap.from_s && stamp_s <= remap.to_s) return remap.stands_for;
  }
  return id;
}

}  // namespace posemix
