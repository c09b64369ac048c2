// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "class_table.hpp"

#include <algorithm>
#include <numeric>
#include <set>

namespace posemix::internal {

ClassTable::ClassTable(const std::vector<ObjectModel>& models, bool on_sight)
    : on_sight_(on_sight) {
  for (const ObjectModel& model : models) ids_[class_of(model)].push_back(model.id);
}

std::vector<ClassTable::Row> ClassTable::assigned(
    const std::vector<LiveDetection>& detections) const {
  std::vector<std::size_t> order(detections.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater(),
                           [&](std::size_t i) { return detections[i].score; });
  std::vector<Row> rows;
  std::set<std::string> taken;
  for (const std::size_t i : order) {
    const std::string& name = detections[i].class_id;
    const auto known = ids_.find(name);
    if (known != ids_.end() && known->second.size() > 1) {
      rows.push_back({i, "", name});
    } else if ((known != ids_.end() || on_sight_) && taken.insert(name).second) {
      rows.push_back({i, known == ids_.end() ? name : known->second.front(), ""});
    }
  }
  return rows;
}

}  // namespace posemix::internal
