// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "trace_pack.hpp"

#include <algorithm>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "io/json_fault.hpp"
#include "io/json_place.hpp"
#include "io/renamed.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"
#include "posemix/results/results.hpp"
#include "trace_entity.hpp"
#include "trace_hypotheses.hpp"
#include "trace_names.hpp"

namespace posemix::internal {
namespace {

using Event = Json::parse_event_t;

/// Of the compressed columns: a page of less than 15 MB. Hypotheses get what the rest leaves, or a
/// part that is enough for the few heaviest ones.
constexpr std::size_t kMostBytes = 10'000'000;
constexpr std::size_t kLeastHypothesisBytes = 1'500'000;

/// Receives the events of the parser. Arrays over frames are taken entry by entry and never kept.
class TracePacker {
 public:
  TracePacker(const std::string& name, const TraceScales& scales)
      : name_(name),
        scales_(scales),
        alternatives_(scales.coarse()),
        joint_(name + ": hypotheses", scales.coarse()) {}

  /// Callback of the parser: returns whether to keep the value.
  bool take(std::size_t depth, Event event, Json& value) {
    if (series_ != nullptr) return take_inside(depth, event, value);
    if (event == Event::key) {
      keys_.resize(depth);
      keys_[depth - 1] = value.get<std::string>();
      // The page does not show whole covariances, which are large.
      const bool of_track = depth == 4 || keys_[0] == "camera";
      return !(of_track && keys_[depth - 1] == "covariance");
    }
    if (event == Event::array_start && depth > 0 && keys_.size() == depth) {
      open(depth);
    } else if (event == Event::object_end && entity_ && depth == entity_depth_) {
      close_entity();
    }
    return true;
  }

  /// Whether the status of detections was there under the name of the release before.
  bool has_old_keys() const { return has_old_keys_; }

  Json finish(const Json& document) {
    const JsonPlace root(document, name_);
    check(root);
    const std::vector<std::string> order = objects_in_order(root);
    write_hypotheses(order);
    const JsonPlace stamps = root.member("stamps_s");
    Json times = Json::array();
    for (const JsonPlace& stamp : stamps.items(frames_)) times.push_back(stamp.number());
    Json statuses = Json::array();
    for (const auto& [word, status] : words<DetectionStatus>) statuses.push_back(word);
    Json healths = Json::array();
    for (const auto& [word, health] : words<TrackHealth>) healths.push_back(word);
    const auto copy = [&](const char* key) { return Json(root.member(key).string()); };
    Json packed = {{"name", copy("name")},
                   {"method", copy("method")},
                   {"conventions", document.value("conventions", Json::object())},
                   {"order", order},
                   {"frames", *frames_},
                   {"stamps_s", std::move(times)},
                   {"statuses", std::move(statuses)},
                   {"healths", std::move(healths)},
                   {"models", model_names(root, order)},
                   {"nees_dof", nees_dofs(root, order)}};
    if (root.has("run")) packed["run"] = copy("run");
    if (kept_) packed["hypotheses_kept"] = *kept_;
    packed["columns"] = std::move(headers_);
    packed["data"] = base64(data_.finish());
    return packed;
  }

  std::optional<std::size_t> kept_hypotheses() const { return kept_; }

 private:
  bool take_inside(std::size_t depth, Event event, const Json& value) {
    const bool ends =
        event == Event::value || event == Event::array_end || event == Event::object_end;
    if (depth == series_depth_ + 1 && ends) {
      series_->add(value);
      return false;
    }
    if (depth == series_depth_ && event == Event::array_end) close_series();
    return true;
  }

  void open(std::size_t depth) {
    if (keys_ == TraceKeys{"hypotheses"}) {
      if (joint_.frames() > 0) throw InvalidInput(joint_.path() + ": got the key again");
      series_ = &joint_;
    } else if (keys_[0] == "camera" && depth == 2) {
      series_ = entity(1, "camera").open({keys_[1]}, scales_);
    } else if (keys_[0] == "objects" && depth >= 3) {
      const TraceKeys within(keys_.begin() + 2, keys_.end());
      series_ = entity(2, "objects/" + keys_[1]).open(within, scales_);
      if (series_ != nullptr && within[0] == "alternatives") has_alternatives_ = true;
    }
    series_depth_ = depth;
  }

  TraceEntity& entity(std::size_t depth, const std::string& prefix) {
    if (entity_) return *entity_;
    if (!entities_.insert(prefix).second) {
      throw InvalidInput(
          fmt::format("{}: got {} again, expected it once", name_, in_quotes(prefix)));
    }
    const std::string path = depth == 1 ? "camera" : "objects: " + keys_[1];
    entity_depth_ = depth;
    return entity_.emplace(name_ + ": " + path, prefix, alternatives_);
  }

  void close_entity() {
    entity_->write(data_, headers_);
    has_old_keys_ = has_old_keys_ || entity_->has_old_keys();
    entity_.reset();
  }

  void close_series() {
    if (!frames_) {
      frames_ = series_->frames();
      first_path_ = series_->path();
    }
    if (series_->frames() != *frames_) {
      throw InvalidInput(fmt::format("{}: got {} entries, expected {} as in {}", series_->path(),
                                     series_->frames(), *frames_, in_quotes(first_path_, 200)));
    }
    series_ = nullptr;
  }

  void check(const JsonPlace& root) {
    root.member("type").require_word("posemix.trace");
    const double schema = root.member("schema").number();
    if (schema != static_cast<double>(kTraceSchema)) {
      root.member("schema").fail(fmt::format("{}", schema),
                                 fmt::format("{}: the file was written in another version of the "
                                             "format",
                                             kTraceSchema));
    }
    if (!entities_.contains("camera")) root.member("camera").fail("no list", "\"pose\" and others");
    const double frames = root.member("frames").number();
    if (frames != static_cast<double>(*frames_)) {
      root.member("frames").fail(fmt::format("{}", frames),
                                 fmt::format("{} as in \"pose\"", *frames_));
    }
  }

  /// The ids under `order`, which must equal the keys of `objects`.
  std::vector<std::string> objects_in_order(const JsonPlace& root) const {
    std::vector<std::string> order;
    std::set<std::string> named{"camera"};
    for (const JsonPlace& item : root.member("order").items()) {
      order.push_back(item.string());
      if (!named.insert("objects/" + order.back()).second) {
        item.fail(in_quotes(order.back()) + " again", "another id");
      }
      if (!entities_.contains("objects/" + order.back())) {
        item.fail(in_quotes(order.back()), "an object with lists under \"objects\"");
      }
    }
    if (named != entities_) {
      root.member("objects").fail("objects that \"order\" lacks", "the same");
    }
    return order;
  }

  /// The names of the models of objects that move, by id.
  static Json model_names(const JsonPlace& root, const std::vector<std::string>& order) {
    Json names = Json::object();
    const JsonPlace objects = root.member("objects");
    for (const std::string& id : order) {
      const JsonPlace object = objects.member(id);
      if (!object.has("model_names")) continue;
      names[id] = Json::array();
      for (const JsonPlace& name : object.member("model_names").items())
        names[id].push_back(name.string());
    }
    return names;
  }

  /// Degrees of freedom of the NEES of the objects that have it, by id.
  static Json nees_dofs(const JsonPlace& root, const std::vector<std::string>& order) {
    Json dofs = Json::object();
    const JsonPlace objects = root.member("objects");
    for (const std::string& id : order) {
      const JsonPlace object = objects.member(id);
      if (object.has("nees_dof")) dofs[id] = object.member("nees_dof").number();
    }
    return dofs;
  }

  /// At the end, so that they get the bytes that the rest leaves.
  void write_hypotheses(const std::vector<std::string>& order) {
    if (!has_alternatives_) {
      std::vector<std::string> prefixes{"camera"};
      for (const std::string& id : order) prefixes.push_back("objects/" + id);
      joint_.name(prefixes);
    }
    HypothesisStore& store = has_alternatives_ ? alternatives_ : joint_.store();
    const std::size_t rest = kMostBytes - std::min(kMostBytes, data_.size());
    store.write(std::max(kLeastHypothesisBytes, rest), data_, headers_);
    kept_ = store.kept();
  }

  std::string name_;
  TraceScales scales_;
  TraceKeys keys_;                 ///< path to the current value, keys only
  TraceSeries* series_ = nullptr;  ///< the array that is being read
  std::size_t series_depth_ = 0;
  std::optional<TraceEntity> entity_;
  std::size_t entity_depth_ = 0;
  std::set<std::string> entities_;  ///< entities read so far
  HypothesisStore alternatives_;
  JointHypotheses joint_;
  std::optional<std::size_t> kept_;  ///< hypotheses of a frame, where some are left out
  bool has_alternatives_ = false;
  bool has_old_keys_ = false;
  std::optional<std::size_t> frames_;
  std::string first_path_;
  Deflater data_;
  Json headers_ = Json::array();
};

using TraceProgress = std::function<void(std::size_t)>;

PackedTrace pack_once(std::istream& text, const std::string& name, const TraceProgress& progress,
                      const TraceScales& scales) {
  constexpr std::size_t kEventsBetween = 1U << 16U;
  TracePacker packer(name, scales);
  std::size_t events = 0;
  const auto take = [&](int depth, Event event, Json& value) {
    check_json_depth(depth, name);
    if (++events % kEventsBetween == 0) progress(static_cast<std::size_t>(text.tellg()));
    return packer.take(static_cast<std::size_t>(depth), event, value);
  };
  try {
    PackedTrace packed{packer.finish(Json::parse(text, take)), {}};
    if (packer.has_old_keys()) {
      packed.warnings.push_back(renamed_warning(name, "key", kOldStatusKey, "status"));
    }
    if (const auto kept = packer.kept_hypotheses()) {
      packed.warnings.push_back(fmt::format(
          "{}: the page has the {} heaviest hypotheses of a frame, as all of them would "
          "make it too large",
          name, *kept));
    }
    return packed;
  } catch (const Json::exception& error) {
    refuse_json(error, name, "trace.json");
  }
}

}  // namespace

PackedTrace pack_trace(std::istream& text, const std::string& name, const TraceProgress& progress) {
  for (TraceScales scales;; scales.position_m *= 10.0) {
    try {
      return pack_once(text, name, progress, scales);
    } catch (const PositionOutOfReach&) {
      text.clear();
      text.seekg(0);
    }
  }
}

}  // namespace posemix::internal
