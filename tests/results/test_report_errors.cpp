// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "io/expect_invalid.hpp"
#include "trace_folder.hpp"

/// Traces that a report refuses.
namespace posemix {
namespace {

using nlohmann::json;
using testing::joint_trace;
using testing::multi_object_trace;
using testing::TraceFolder;

/// Message about the trace with one value changed.
std::string damaged(const json& trace, const char* pointer, const json& value) {
  json copy = trace;
  copy[json::json_pointer(pointer)] = value;
  const TraceFolder folder(copy);
  return testing::invalid_input_message([&] { static_cast<void>(folder.report()); });
}

void expect_message(const std::string& message, const std::string& end) {
  EXPECT_TRUE(message.ends_with(end)) << message;
  EXPECT_NE(message.find("/trace.json: "), std::string::npos) << message;
}

TEST(ReportErrors, NameThePlace) {
  const json& trace = multi_object_trace();
  expect_message(damaged(trace, "/schema", 2),
                 "trace.json: schema: got 2, expected 1: the file was written in another version "
                 "of the format");
  expect_message(damaged(trace, "/type", "posemix.posterior"),
                 "trace.json: type: got \"posemix.posterior\", expected \"posemix.trace\"");
  expect_message(damaged(trace, "/frames", 21), "frames: got 21, expected 20 as in \"pose\"");
  expect_message(damaged(trace, "/stamps_s", {1, 2}), "stamps_s: got 2 entries, expected 20");
  expect_message(damaged(trace, "/camera/pose/4/2", "x"),
                 "trace.json: camera: pose[4][2]: got string, expected a number");
  expect_message(damaged(trace, "/camera/pose/4", {1, 2}),
                 "camera: pose[4]: got 2 entries, expected 7");
  expect_message(damaged(trace, "/camera/pose/4", 5),
                 "camera: pose[4]: got number, expected an array");
  expect_message(damaged(trace, "/camera/pose/4/0", 1e9),
                 "camera: pose[4][0]: got 1000000000, expected a number from -100000000 to "
                 "100000000");
  expect_message(damaged(trace, "/camera/pose/4/6", 7), "expected norm 1");
  expect_message(damaged(trace, "/camera/sd/4", nullptr),
                 "camera: sd[4]: got null, expected numbers as in \"pose\"");
  expect_message(damaged(trace, "/camera/sd/4/1", -1.0),
                 "camera: sd[4][1]: got -1, expected no negative number");
  expect_message(damaged(trace, "/objects/mug/world/position_covariance/6/3", -1.0),
                 "objects: mug: world: position_covariance[6][3]: got -1, expected a variance");
  expect_message(damaged(trace, "/objects/mug/status/3", "gone"),
                 "objects: mug: status[3]: got \"gone\", expected the status of a detection");
  expect_message(damaged(trace, "/objects/mug/alternatives/3/0/id", 0.5),
                 "objects: mug: alternatives[3][0]: id: got 0.5, expected an integer");
  expect_message(damaged(trace, "/objects/mug/alternatives/3/0/probability", 1.5),
                 "probability: got 1.5, expected a probability");
  expect_message(damaged(trace, "/objects/mug/alternatives/3/0", {{"id", 1}}),
                 "objects: mug: alternatives[3][0]: got no key 'probability', expected one");
  EXPECT_NE(damaged(trace, "/objects/mug/status", {"used"})
                .find("objects: mug: status: got 1 entries, expected 20 as in"),
            std::string::npos);
}

TEST(ReportErrors, OfTheWhole) {
  const json& trace = joint_trace();
  expect_message(damaged(trace, "/camera", json::object()),
                 "camera: got no list, expected \"pose\" and others");
  expect_message(damaged(trace, "/order", {"mug", "box"}),
                 "objects: got objects that \"order\" lacks, expected the same");
  expect_message(damaged(trace, "/order/2", "mug"),
                 "order[2]: got \"mug\" again, expected another id");
  expect_message(damaged(trace, "/order/2", "cup"),
                 "order[2]: got \"cup\", expected an object with lists under \"objects\"");
  expect_message(damaged(trace, "/objects/can/detection", 3),
                 "objects: can: got no list \"detection\", expected one");
  expect_message(damaged(trace, "/hypotheses/0/0/poses", json::array()),
                 "hypotheses[0][0]: poses: got no poses, expected the camera's and the objects'");
  expect_message(damaged(trace, "/hypotheses/0/1/poses/3", json::array()),
                 "hypotheses[0][1]: poses[3]: got 0 entries, expected 7");
  const auto message = [](const std::string& text) {
    const TraceFolder folder(text);
    return testing::invalid_input_message([&] { static_cast<void>(folder.report()); });
  };
  const std::string text = trace.dump();
  EXPECT_NE(message(text.substr(0, text.size() / 2)).find("got a text that is not JSON"),
            std::string::npos);
  EXPECT_NE(message("").find("got a text that is not JSON"), std::string::npos);
  expect_message(message("[]"), "trace.json: got array, expected an object");
  expect_message(message("{\"camera\":{\"pose\":[],\"pose\":[]}}"),
                 "camera: pose: got the key again, expected it once");
}

}  // namespace
}  // namespace posemix
