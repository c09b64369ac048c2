// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "detections.hpp"
#include "posemix/slam/object_model.hpp"

namespace posemix::internal {

/// Which object or class a detection is of, by the class that it has.
class ClassTable {
 public:
  /// Where `on_sight`, a class that no model has is an object of its own, named as the class.
  explicit ClassTable(const std::vector<ObjectModel>& models = {}, bool on_sight = false);

  /// A detection of an image, with the object or the class that it is of.
  struct Row {
    std::size_t detection;
    std::string object;
    std::string class_id;
  };
  /// The detections of an image, the highest score first. A class with one model has one at most;
  /// those of other classes than those of the models are left out.
  std::vector<Row> assigned(const std::vector<LiveDetection>& detections) const;

 private:
  std::map<std::string, std::vector<std::string>> ids_;  ///< by class
  bool on_sight_;
};

}  // namespace posemix::internal
