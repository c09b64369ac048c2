// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "settings.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <variant>

#include <fmt/format.h>

#include "config/sequence_parts.hpp"
#include "messages.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix::internal {
namespace {

using NoiseModels = std::map<std::string, DetectorNoise>;

constexpr NumberRange kSeconds{.lowest = 0, .highest = 1e6, .without_lowest = true};
constexpr NumberRange kHertz{.lowest = 0, .highest = 1e4, .without_lowest = true};
constexpr NumberRange kOffset{.lowest = -1e6, .highest = 1e6};
constexpr IntegerRange kCount{.lowest = 1, .highest = 1000000};
constexpr std::int64_t kReportImages = 20000;

std::size_t count_or(const TomlTable& table, std::string_view key, std::size_t otherwise) {
  return static_cast<std::size_t>(
      table.get_integer_or(key, static_cast<std::int64_t>(otherwise), kCount));
}

/// A part of the name of a topic: what ROS 2 takes as the name of a node.
std::string node_name(const TomlTable& table, const std::string& otherwise) {
  std::string name = table.get_string_or("name", otherwise);
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  };
  if (name.empty() || !std::ranges::all_of(name, fits) || (name[0] >= '0' && name[0] <= '9')) {
    table.fail("name", fmt::format("is {}, expected letters, digits and '_', no digit first",
                                   in_quotes(name)));
  }
  return name;
}

LiveNodeSettings read_node(const TomlTable& root) {
  LiveNodeSettings s;
  const auto table = root.find_table("live");
  if (!table) return s;
  s.name = node_name(*table, s.name);
  s.world_frame = frame_name(table->get_string_or("world_frame", s.world_frame));
  s.odom_frame = frame_name(table->get_string_or("odom_frame", s.odom_frame));
  s.odometry_topic = table->get_string_or("odometry_topic", s.odometry_topic);
  s.camera_frame = frame_name(table->get_string_or("camera_frame", s.camera_frame));
  s.body_frame = frame_name(table->get_string_or("body_frame", s.body_frame));
  s.cameras = table->get_strings_or("cameras", s.cameras);
  for (std::string& camera : s.cameras) camera = frame_name(camera);
  s.max_gap_s = table->get_double_or("max_gap_s", s.max_gap_s, kSeconds);
  s.transform_timeout_s =
      table->get_double_or("transform_timeout_s", s.transform_timeout_s, kSeconds);
  s.queue_size = count_or(*table, "queue_size", s.queue_size);
  s.input_depth = count_or(*table, "input_depth", s.input_depth);
  s.empty_is_image = table->get_bool_or("empty_is_image", s.empty_is_image);
  s.use_sim_time = table->get_bool_or("use_sim_time", s.use_sim_time);
  s.least_existence = table->get_double_or("least_existence", s.least_existence, kUnitInterval);
  s.publish_tf = table->get_bool_or("publish_tf", s.publish_tf);
  s.publish_world_tf = table->get_bool_or("publish_world_tf", s.publish_world_tf);
  s.tf_prefix = table->get_string_or("tf_prefix", s.tf_prefix);
  s.transform_time_offset_s =
      table->get_double_or("transform_time_offset_s", s.transform_time_offset_s, kOffset);
  s.diagnostics_hz = table->get_double_or("diagnostics_hz", s.diagnostics_hz, kHertz);
  return s;
}

LiveSource read_source(const TomlTable& table, std::size_t index, const NoiseModels& noise_models) {
  LiveSource source;
  source.name = node_name(table, source.name);
  source.detector = index == 0 ? "" : source.name;
  source.topic = table.get_string_or("topic", "~/" + source.name);
  source.flat = table.get_enum_or<bool>("type", source.flat,
                                        {{"Detection3DArray", false}, {"Detection2DArray", true}});
  source.frame = frame_name(table.get_string_or("frame", source.frame));
  source.of_box =
      table.get_enum_or<bool>("pose", source.of_box, {{"result", false}, {"bbox", true}});
  if (source.of_box && source.flat)
    table.fail("pose", "is \"bbox\", but the boxes of a Detection2DArray have no pose");
  source.least_score = table.get_double_or("least_score", source.least_score);
  source.reliable = table.get_enum_or<bool>("reliability", source.reliable,
                                            {{"best_effort", false}, {"reliable", true}});
  source.noise = noise_of(table, noise_models, "noise");
  return source;
}

std::vector<LiveSource> read_sources(const TomlTable& root, const NoiseModels& noise_models) {
  std::vector<LiveSource> sources;
  std::set<std::string> names;
  for (const TomlTable& table : root.find_tables("sources")) {
    sources.push_back(read_source(table, sources.size(), noise_models));
    if (!names.insert(sources.back().name).second)
      table.fail("name", fmt::format("is {}, which another source has already",
                                     in_quotes(sources.back().name)));
  }
  if (sources.empty()) sources.emplace_back();
  return sources;
}

/// Every source has a noise, of the source itself unless the model has one.
void add_sources(const std::vector<LiveSource>& sources, ObjectModel& model) {
  for (const LiveSource& source : sources) {
    if (!source.detector.empty()) model.detectors.try_emplace(source.detector, source.noise);
  }
}

/// Noise that an object's table does not state is that of the sources.
void use_sources(const TomlTable& table, const std::vector<LiveSource>& sources,
                 ObjectModel& model) {
  if (!table.has("noise")) model.noise = sources.front().noise;
  for (const auto& [name, noise] : model.detectors) {
    const bool is_source = std::ranges::any_of(
        sources, [&name = name](const LiveSource& s) { return s.detector == name; });
    if (!is_source) {
      table.fail("detectors",
                 fmt::format("has {}, expected names of [[sources]] but the first, whose noise is "
                             "`noise`",
                             in_quotes(name)));
    }
  }
  add_sources(sources, model);
}

/// Objects that were declared, and that of a class which none of them has; without any all are.
void read_objects(const TomlTable& root, const FileFinder& files, const NoiseModels& noise_models,
                  LiveSettings& settings) {
  const std::vector<TomlTable> tables = root.find_tables("objects");
  settings.models = read_object_models(tables, files, noise_models, {});
  for (std::size_t i = 0; i < tables.size(); ++i) {
    use_sources(tables[i], settings.sources, settings.models[i]);
    if (settings.models[i].independent_start)
      tables[i].fail("start", "is for other filters, expected none");
    located(tables[i], "id", [&] {
      require_alike_in_class(std::span<const ObjectModel>(settings.models).first(i + 1));
    });
  }
  if (const auto table = root.find_table("on_sight")) {
    settings.tracker.on_sight = read_model_on_sight(*table, files, noise_models, {});
    use_sources(*table, settings.sources, *settings.tracker.on_sight);
  } else if (tables.empty()) {
    ObjectModel& model = settings.tracker.on_sight.emplace();
    model.noise = settings.sources.front().noise;
    add_sources(settings.sources, model);
  }
  if (settings.tracker.on_sight) settings.tracker.on_sight->id = "on_sight";
}

NoiseModels read_noise(const TomlTable& root, double default_clutter) {
  NoiseModels models = read_noise_models(root);
  std::set<std::string> used;
  for (const TomlTable& table : root.find_tables("objects")) add_used_noise(table, used);
  for (const TomlTable& table : root.find_tables("sources"))
    used.insert(table.get_string_or("noise", "default"));
  if (const auto table = root.find_table("on_sight")) add_used_noise(*table, used);
  assume_missing(root, used, default_clutter, models);
  return models;
}

void read_method(const TomlTable& root, LiveSettings& settings) {
  const SlamMethod method = read_filter(root);
  const auto* tracker = std::get_if<MultiObjectSlamSettings>(&method.tracker);
  if (tracker == nullptr)
    root.get_table("filter").fail("method", "is of recordings, expected \"multi_object\"");
  if (method.smoothing)
    root.get_table("filter").fail("smooth", "is of recordings, expected \"none\"");
  settings.tracker = *tracker;
  settings.method = method.title();
}

StampedSlamSettings read_stamped_settings(const TomlTable& root) {
  // A recording that is played again, or a simulation that starts again, is no error of a robot.
  StampedSlamSettings s{.on_jump_back = StampJump::reset};
  const auto table = root.find_table("stamped");
  if (!table) return s;
  s.history_s = table->get_double_or("history_s", s.history_s, kSeconds);
  s.jump_back_s = table->get_double_or("jump_back_s", s.jump_back_s, kSeconds);
  s.on_jump_back = table->get_enum_or("on_jump_back", s.on_jump_back);
  s.jump_ahead_s = table->get_double_or("jump_ahead_s", s.jump_ahead_s, kSeconds);
  s.checkpoints = count_or(*table, "checkpoints", s.checkpoints);
  if (s.jump_back_s < s.history_s)
    table->fail("jump_back_s", fmt::format("is {}, expected at least history_s, which is {}",
                                           s.jump_back_s, s.history_s));
  return s;
}

void read_start(const TomlTable& root, LiveSettings& settings) {
  if (starts_anywhere(root)) {
    settings.start = prior_anywhere(root, settings.models);
    settings.starts_at_odometry = false;
    return;
  }
  settings.start = read_camera_prior(root, {});
  const auto camera = root.find_table("camera");
  const auto start = camera ? camera->find_table("start") : std::nullopt;
  settings.starts_at_odometry = !start || !start->has("pose");
}

void read_output(const TomlTable& root, LiveSettings& settings) {
  const auto output = root.find_table("output");
  const auto number = [&](const char* key, std::int64_t otherwise, const IntegerRange& range) {
    return static_cast<std::size_t>(output ? output->get_integer_or(key, otherwise, range)
                                           : otherwise);
  };
  settings.trace_hypotheses = number("trace_hypotheses", kTraceHypotheses, kAtLeastZero);
  settings.report_images = number("images", kReportImages, kCount);
}

}  // namespace

bool LiveSettings::has_odometry() const {
  return motion.model == MotionModel::odometry || motion.model == MotionModel::given;
}

LiveSettings read_live_settings(const TomlDocument& document,
                                const std::vector<std::filesystem::path>& folders) {
  const TomlTable root = document.root();
  const std::int64_t schema = root.get_integer("schema");
  if (schema != kLiveSchema) {
    root.fail("schema", fmt::format("is {}, expected {}: this is another version of the file",
                                    schema, kLiveSchema));
  }
  LiveSettings settings;
  const FileFinder files(folders, root.get_strings_or("roots", {"."}));
  settings.node = read_node(root);
  read_method(root, settings);
  const NoiseModels noise_models = read_noise(root, settings.tracker.filter.default_clutter);
  settings.sources = read_sources(root, noise_models);
  read_objects(root, files, noise_models, settings);
  settings.motion = read_motion(root, true);
  settings.stamped = read_stamped_settings(root);
  read_start(root, settings);
  read_output(root, settings);
  document.finish();
  return settings;
}

std::string topic_name(const LiveNodeSettings& node, const std::string& topic) {
  if (topic.starts_with("~/")) return "/" + node.name + topic.substr(1);
  return topic.starts_with('/') ? topic : "/" + topic;
}

}  // namespace posemix::internal
