// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "ros_graph.hpp"

#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "ros_domain.hpp"
#include "ros_wire.hpp"

/// Cyclone DDS 0.10 reads the answers of Fast DDS to anyone's question about a type, and crashes in
/// some (a segmentation fault below ddsi_xt_type_add_typeobj): a second type on one of the topics
/// made two other programs ask. The types of this program have no such information, so it needs
/// neither questions nor answers. The library calls both by name, and finds these first.
// NOLINTBEGIN(readability-identifier-naming)
extern "C" void ddsi_tl_handle_reply(void* domain, void* message);
extern "C" void ddsi_tl_handle_request(void* domain, void* message);
extern "C" void ddsi_tl_handle_reply(void* /*domain*/, void* /*message*/) {}
extern "C" void ddsi_tl_handle_request(void* /*domain*/, void* /*message*/) {}
// NOLINTEND(readability-identifier-naming)

namespace posemix::internal {
namespace {

/// Quality of service, as far as topics differ.
struct TopicQuality {
  std::size_t depth;
  bool reliable = true;
  bool latched = false;  ///< those that come later receive it, too
};

/// The last messages that were not taken so far.
constexpr std::size_t kTransformDepth = 100;
/// The last messages that are kept for subscriptions that have not confirmed them.
constexpr std::size_t kPublishedDepth = 10;
/// For subscriptions that do not keep up nothing waits: what comes next is newer.
constexpr dds_duration_t kBlocked = 0;

dds_entity_t checked(dds_entity_t code, const std::string& what) {
  if (code < 0)
    throw GraphError(fmt::format("{}: Cyclone DDS says: {}", what, dds_strretcode(-code)));
  return code;
}

using Qos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

Qos qos_of(const TopicQuality& quality) {
  Qos qos(dds_create_qos(), &dds_delete_qos);
  const auto depth = static_cast<std::int32_t>(quality.depth);
  dds_qset_reliability(qos.get(),
                       quality.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       kBlocked);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, depth);
  dds_qset_durability(qos.get(),
                      quality.latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, depth, DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  // What this program says in /tf it knows.
  dds_qset_ignorelocal(qos.get(), DDS_IGNORELOCAL_PARTICIPANT);
  const dds_data_representation_id_t representation = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_data_representation(qos.get(), 1, &representation);
  return qos;
}

/// The policy of a mismatch in the words of ROS 2.
std::string policy_name(std::uint32_t id) {
  if (id == DDS_RELIABILITY_QOS_POLICY_ID) return "reliability";
  if (id == DDS_DURABILITY_QOS_POLICY_ID) return "durability";
  return fmt::format("quality of service (policy {} of DDS)", id);
}

/// An endpoint with the name of its topic.
struct Endpoint {
  dds_entity_t entity = 0;
  std::string topic = {};
};

/// Takes all messages of a reader, and makes a value of each.
template <class Message, class Take>
void take_all(const Endpoint& reader, const Take& take) {
  constexpr std::size_t kAtOnce = 32;
  if (reader.entity == 0) return;
  dds_return_t count = kAtOnce;
  while (count == kAtOnce) {
    std::array<void*, kAtOnce> samples{};
    std::array<dds_sample_info_t, kAtOnce> infos;
    count = dds_take(reader.entity, samples.data(), infos.data(), kAtOnce, kAtOnce);
    for (dds_return_t i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (infos[k].valid_data) take(*static_cast<const Message*>(samples[k]));
    }
    if (count > 0) dds_return_loan(reader.entity, samples.data(), count);
  }
}

}  // namespace

struct RosGraph::Parts {
  explicit Parts(const LiveSettings& settings);
  ~Parts() {
    dds_delete(participant);
    if (own_domain != 0) dds_delete(own_domain);
  }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  dds_entity_t topic(const dds_topic_descriptor_t& type, const std::string& name) const;
  Endpoint reader(const dds_topic_descriptor_t& type, const std::string& name,
                  const TopicQuality& quality);
  Endpoint writer(const dds_topic_descriptor_t& type, const std::string& name,
                  const TopicQuality& quality);
  void listen(const LiveSettings& settings);
  void announce(const LiveSettings& settings);

  std::uint32_t domain = ros_domain();
  dds_entity_t own_domain = 0;
  dds_entity_t participant = 0;
  dds_entity_t waitset = 0;
  std::vector<Endpoint> sources = {};
  std::vector<bool> is_flat = {};
  Endpoint transforms = {};
  Endpoint fixed_transforms = {};
  Endpoint odometry = {};
  Endpoint clock = {};
  Endpoint reset = {};
  Endpoint objects = {};
  Endpoint own_transforms = {};
  Endpoint diagnostics = {};
  std::vector<Endpoint> readers = {};
  std::vector<Endpoint> writers = {};
  std::size_t unsent = 0;
};

RosGraph::Parts::Parts(const LiveSettings& settings) {
  if (const std::string loopback = loopback_configuration(); !loopback.empty())
    own_domain = checked(dds_create_domain(domain, loopback.c_str()), "the domain");
  const std::string place = fmt::format("domain {}", domain);
  participant = checked(dds_create_participant(domain, nullptr, nullptr), place);
  try {
    waitset = checked(dds_create_waitset(participant), place);
    listen(settings);
    announce(settings);
  } catch (...) {
    dds_delete(participant);
    if (own_domain != 0) dds_delete(own_domain);
    throw;
  }
}

dds_entity_t RosGraph::Parts::topic(const dds_topic_descriptor_t& type,
                                    const std::string& name) const {
  // ROS 2 puts what is neither a service nor a parameter below rt.
  return checked(dds_create_topic(participant, &type, ("rt" + name).c_str(), nullptr, nullptr),
                 name);
}

Endpoint RosGraph::Parts::reader(const dds_topic_descriptor_t& type, const std::string& name,
                                 const TopicQuality& quality) {
  const Qos qos = qos_of(quality);
  const Endpoint made{
      checked(dds_create_reader(participant, topic(type, name), qos.get(), nullptr), name), name};
  const dds_entity_t condition =
      checked(dds_create_readcondition(made.entity, DDS_ANY_STATE), name);
  checked(dds_waitset_attach(waitset, condition, 0), name);
  return readers.emplace_back(made);
}

Endpoint RosGraph::Parts::writer(const dds_topic_descriptor_t& type, const std::string& name,
                                 const TopicQuality& quality) {
  const Qos qos = qos_of(quality);
  const Endpoint made{
      checked(dds_create_writer(participant, topic(type, name), qos.get(), nullptr), name), name};
  return writers.emplace_back(made);
}

void RosGraph::Parts::listen(const LiveSettings& settings) {
  const LiveNodeSettings& node = settings.node;
  for (const LiveSource& source : settings.sources) {
    const auto& type = source.flat ? vision_msgs_msg_dds__Detection2DArray__desc
                                   : vision_msgs_msg_dds__Detection3DArray__desc;
    sources.push_back(reader(type, topic_name(node, source.topic),
                             {.depth = node.input_depth, .reliable = source.reliable}));
    is_flat.push_back(source.flat);
  }
  transforms = reader(tf2_msgs_msg_dds__TFMessage__desc, "/tf", {.depth = kTransformDepth});
  fixed_transforms = reader(tf2_msgs_msg_dds__TFMessage__desc, "/tf_static",
                            {.depth = kTransformDepth, .latched = true});
  reset = reader(std_msgs_msg_dds__Empty__desc, topic_name(node, "~/reset"), {.depth = 1});
  if (!node.odometry_topic.empty()) {
    odometry = reader(nav_msgs_msg_dds__Odometry__desc, topic_name(node, node.odometry_topic),
                      {.depth = node.input_depth, .reliable = false});
  }
  if (node.use_sim_time) {
    clock = reader(rosgraph_msgs_msg_dds__Clock__desc, "/clock", {.depth = 1, .reliable = false});
  }
}

void RosGraph::Parts::announce(const LiveSettings& settings) {
  objects = writer(vision_msgs_msg_dds__Detection3DArray__desc,
                   topic_name(settings.node, "~/objects"), {.depth = 1, .latched = true});
  own_transforms = writer(tf2_msgs_msg_dds__TFMessage__desc, "/tf", {.depth = kPublishedDepth});
  diagnostics = writer(diagnostic_msgs_msg_dds__DiagnosticArray__desc, "/diagnostics",
                       {.depth = kPublishedDepth});
}

RosGraph::RosGraph(const LiveSettings& settings) : parts_(std::make_unique<Parts>(settings)) {}

RosGraph::~RosGraph() = default;

std::uint32_t RosGraph::domain() const { return parts_->domain; }

void RosGraph::wait(double timeout_s) {
  const auto timeout = static_cast<dds_duration_t>(std::llround(timeout_s * 1e9));
  dds_waitset_wait(parts_->waitset, nullptr, 0, timeout);
}

std::vector<RosDetections> RosGraph::take_detections(std::size_t source) {
  std::vector<RosDetections> found;
  const auto add = [&](const auto& message) { found.push_back(plain(message)); };
  if (parts_->is_flat[source]) {
    take_all<vision_msgs_msg_dds__Detection2DArray_>(parts_->sources[source], add);
  } else {
    take_all<vision_msgs_msg_dds__Detection3DArray_>(parts_->sources[source], add);
  }
  return found;
}

std::vector<RosTransform> RosGraph::take_transforms(bool is_static) {
  std::vector<RosTransform> found;
  take_all<tf2_msgs_msg_dds__TFMessage_>(
      is_static ? parts_->fixed_transforms : parts_->transforms, [&](const auto& message) {
        for (std::uint32_t i = 0; i < message.transforms._length; ++i)
          found.push_back(plain(message.transforms._buffer[i]));
      });
  return found;
}

std::vector<RosTransform> RosGraph::take_odometry() {
  std::vector<RosTransform> found;
  take_all<nav_msgs_msg_dds__Odometry_>(
      parts_->odometry, [&](const auto& message) { found.push_back(plain(message)); });
  return found;
}

std::vector<std::int64_t> RosGraph::take_clock() {
  std::vector<std::int64_t> found;
  take_all<rosgraph_msgs_msg_dds__Clock_>(
      parts_->clock, [&](const auto& message) { found.push_back(nanoseconds_of(message.clock)); });
  return found;
}

bool RosGraph::take_reset() {
  bool any = false;
  take_all<std_msgs_msg_dds__Empty_>(parts_->reset, [&](const auto&) { any = true; });
  return any;
}

void RosGraph::publish(const RosDetections& message) {
  parts_->unsent += write_message(parts_->objects.entity, message) != DDS_RETCODE_OK;
}

void RosGraph::publish(const std::vector<RosTransform>& message) {
  parts_->unsent += write_message(parts_->own_transforms.entity, message) != DDS_RETCODE_OK;
}

void RosGraph::publish(const RosDiagnostics& message) {
  parts_->unsent += write_message(parts_->diagnostics.entity, message) != DDS_RETCODE_OK;
}

GraphCounts RosGraph::counts() const {
  GraphCounts counts{.publishers = 0, .unsent = parts_->unsent};
  for (const Endpoint& reader : parts_->readers) {
    dds_subscription_matched_status_t status{};
    dds_get_subscription_matched_status(reader.entity, &status);
    counts.publishers += status.current_count;
  }
  return counts;
}

std::vector<std::string> RosGraph::take_mismatches() {
  std::vector<std::string> found;
  const auto add = [&](const char* other, const Endpoint& endpoint, std::uint32_t policy) {
    found.push_back(fmt::format("a {} of {} has another {}, so that nothing passes", other,
                                endpoint.topic, policy_name(policy)));
  };
  for (const Endpoint& reader : parts_->readers) {
    dds_requested_incompatible_qos_status_t status{};
    dds_get_requested_incompatible_qos_status(reader.entity, &status);
    if (status.total_count_change > 0) add("publisher", reader, status.last_policy_id);
  }
  for (const Endpoint& writer : parts_->writers) {
    dds_offered_incompatible_qos_status_t status{};
    dds_get_offered_incompatible_qos_status(writer.entity, &status);
    if (status.total_count_change > 0) add("subscription", writer, status.last_policy_id);
  }
  return found;
}

}  // namespace posemix::internal
