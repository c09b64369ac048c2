// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/dataset_sequence.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "json_numbers.hpp"
#include "paths.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/bop.hpp"
#include "posemix/io/bop_models.hpp"
#include "posemix/io/dataset.hpp"
#include "posemix/io/text.hpp"
#include "toml_string.hpp"

namespace posemix {
namespace {

using namespace internal;

namespace fs = std::filesystem;

std::string toml_path(const fs::path& path) { return toml_string(absolute_path(path).string()); }

class SequenceWriter {
 public:
  explicit SequenceWriter(const DatasetSequence& request) : request_(request) {
    const std::string sequence = fmt::format("{:04}", request.scene);
    is_ycb_video_ = is_folder(request.dataset / "data" / sequence);
    scene_ = is_ycb_video_ ? read_ycb_video_scene(request.dataset, sequence)
                           : read_bop_scene(request.dataset, request.split, request.scene);
    place_ =
        is_ycb_video_
            ? fmt::format("ycb_video = {}, sequence = \"{}\"", toml_path(request.dataset), sequence)
            : fmt::format("bop_dataset = {}, split = {}, scene = {}", toml_path(request.dataset),
                          toml_string(request.split), request.scene);
    if (is_ycb_video_) names_ = read_ycb_video_names(request.dataset);
    instances_ = scene_.instance_counts();
    read_estimates();
    find_models();
    first_frame_ = *scene_.image_ids().begin();
  }

  DatasetSequenceText write() {
    std::string text = fmt::format("# Scene {} of {}, written by posemix data sequence.\n",
                                   request_.scene, fs::path(scene_.name).string());
    text += fmt::format("schema = 1\nsequence = \"{}\"\n\n[camera]\n", request_.scene);
    text += camera();
    std::string candidates;
    for (const auto& [object, most] : estimates_) {
      if (instance_count(object) > 1) {
        text += instances(object);
        candidates += candidate_table(object);
      } else {
        text += single(object);
      }
    }
    return {text + candidates, notes_};
  }

 private:
  void read_estimates() {
    std::map<std::pair<std::int64_t, std::int64_t>, std::size_t> counts;
    for (const BopRow& row : read_bop_rows(request_.results)) {
      if (row.scene != request_.scene) continue;
      if (request_.min_score && row.score < *request_.min_score) continue;
      if (!is_wanted(row.object)) continue;
      std::size_t& most = estimates_[row.object];
      most = std::max(most, ++counts[{row.object, row.image}]);
    }
    drop_unannotated();
    if (estimates_.empty()) {
      throw InvalidInput(
          fmt::format("{}: got no estimate of the wanted objects in scene {}, "
                      "expected at least one",
                      request_.results.string(), request_.scene));
    }
  }

  bool is_wanted(std::int64_t object) const {
    const auto& wanted = request_.objects;
    return wanted.empty() || std::find(wanted.begin(), wanted.end(), object) != wanted.end();
  }

  /// Leaves out estimated objects that are not annotated, because they are not in the scene, and
  /// notes annotated objects without estimates, because they cannot be tracked.
  void drop_unannotated() {
    for (const auto& [object, count] : instances_) {
      if (is_wanted(object) && !estimates_.contains(object))
        notes_.push_back(
            fmt::format("object {} is left out: the results have no estimate of it", object));
    }
    if (instances_.empty()) return;
    std::erase_if(estimates_, [&](const auto& entry) {
      if (instances_.contains(entry.first)) return false;
      notes_.push_back(
          fmt::format("object {} is left out: it has estimates, but the scene does "
                      "not have it",
                      entry.first));
      return true;
    });
  }

  void find_models() {
    for (const char* folder : {"models", "models_eval", "models_cad"}) {
      const fs::path path = request_.dataset / folder / "models_info.json";
      if (!is_there(path)) continue;
      models_path_ = path;
      for (const auto& [id, model] : read_bop_models(path)) models_.insert(id);
      return;
    }
    notes_.emplace_back("no symmetries are declared: the dataset's models_info.json is not there");
  }

  std::size_t instance_count(std::int64_t object) const {
    const auto annotated = instances_.find(object);
    return annotated != instances_.end() ? annotated->second : estimates_.at(object);
  }

  std::string camera() {
    const auto is_known = [](const auto& entry) { return entry.second.has_value(); };
    const bool known = std::any_of(scene_.cameras.begin(), scene_.cameras.end(), is_known);
    std::string text;
    if (request_.odometry) text += fmt::format("odometry = {}\n", toml_path(*request_.odometry));
    if (known)
      text += fmt::format("ground_truth = {{{}, first_frame = {}}}\n", place_, first_frame_);
    else
      notes_.emplace_back("the camera has no ground truth: the dataset does not say how it moved");
    if (request_.lever_arm_m) {
      const Eigen::Vector3d& arm = *request_.lever_arm_m;
      text += fmt::format("lever_arm_m = [{}, {}, {}]\n", arm.x(), arm.y(), arm.z());
    }
    if (request_.frame_period_s)
      text += fmt::format("frame_period_s = {}\n", *request_.frame_period_s);
    return text;
  }

  std::string id_of(std::int64_t object) const {
    const bool has_name = object >= 1 && static_cast<std::size_t>(object) <= names_.size();
    return has_name ? names_[static_cast<std::size_t>(object - 1)] : std::to_string(object);
  }

  std::string results_keys(std::int64_t object, std::string_view separator) const {
    std::vector<std::string> keys{fmt::format("scene = {}", request_.scene),
                                  fmt::format("object = {}", object),
                                  fmt::format("first_frame = {}", first_frame_)};
    if (request_.min_score) keys.push_back(fmt::format("min_score = {}", *request_.min_score));
    return fmt::format("{}", fmt::join(keys, separator));
  }

  std::string symmetries(std::int64_t object) const {
    if (!models_.contains(object)) return "";
    return fmt::format("symmetries = {{bop_models_info = {}, object = {}}}\n",
                       toml_path(models_path_), object);
  }

  std::string single(std::int64_t object) const {
    std::string text = fmt::format("\n[[objects]]\nid = {}\n", toml_string(id_of(object)));
    text += fmt::format("detections = {{bop = {}, {}}}\n", toml_path(request_.results),
                        results_keys(object, ", "));
    if (instances_.contains(object))
      text += fmt::format("ground_truth = {{{}, object = {}, first_frame = {}}}\n", place_, object,
                          first_frame_);
    return text + symmetries(object);
  }

  std::string instances(std::int64_t object) {
    const std::size_t count = instance_count(object);
    std::string text;
    for (std::size_t i = 1; i <= count; ++i) {
      text += fmt::format("\n[[objects]]\nid = {}\nclass = {}\n",
                          toml_string(fmt::format("{}_{}", id_of(object), i)),
                          toml_string(id_of(object)));
      text += symmetries(object);
    }
    notes_.push_back(
        fmt::format("object {} is there {} times: its estimates are candidates, and "
                    "which instance an object follows is not known before, so that it "
                    "has no ground truth",
                    object, count));
    return text;
  }

  std::string candidate_table(std::int64_t object) const {
    return fmt::format("\n[[candidates]]\nclass = {}\nbop = {}\n{}\n", toml_string(id_of(object)),
                       toml_path(request_.results), results_keys(object, "\n"));
  }

  const DatasetSequence& request_;
  bool is_ycb_video_ = false;
  DatasetScene scene_;
  std::string place_;  // the keys that name the scene
  std::vector<std::string> names_;
  std::map<std::int64_t, std::size_t> instances_;
  // Largest number of estimates of an object in one image.
  std::map<std::int64_t, std::size_t> estimates_;
  std::set<std::int64_t> models_;
  fs::path models_path_;
  std::int64_t first_frame_ = 1;
  std::vector<std::string> notes_;
};

}  // namespace

DatasetSequenceText format_dataset_sequence(const DatasetSequence& request) {
  return SequenceWriter(request).write();
}

}  // namespace posemix
