// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "posemix/io/ply.hpp"
#include "posemix/results/report.hpp"
#include "posemix/testing/mutate.hpp"
#include "small_results.hpp"

/// Damaged traces and meshes.
namespace posemix {
namespace {

using testing::fuzz;
using testing::FuzzReport;

void expect_sound_reports(const FuzzReport& report, std::size_t least_of_each) {
  EXPECT_TRUE(report.failures.empty())
      << report.failures.size() << " failures, the first: " << report.failures[0];
  EXPECT_GT(report.accepted, least_of_each);
  EXPECT_GT(report.rejected, least_of_each);
}

/// The trace with line ends, for damage by lines.
std::string lines_of(std::string trace) {
  for (std::size_t at = 0; (at = trace.find("],[", at)) != std::string::npos; ++at) {
    trace.insert(at + 2, "\n");
  }
  return trace;
}

TEST(DamagedReport, Traces) {
  std::vector<std::string> originals;
  for (const std::string filter : {"filter={}", "filter={method='gm-iekf', max_components=2}"}) {
    const testing::SmallResults results({filter, "output.trace_hypotheses=2"});
    originals.push_back(lines_of(results.files.at("trace.json")));
  }
  const testing::TemporaryFolder folder;
  folder.put("metrics.json", "{}");
  const auto parse = [&](const std::string& text) {
    folder.put("trace.json", text);
    format_report(folder.path());
  };
  expect_sound_reports(fuzz(originals, 1500, 31, parse), 20);
}

TEST(DamagedReport, Meshes) {
  const std::vector<std::string> originals{
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 2 1 0\n4 0 1 2 3\n",
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty char x\nproperty char y\n"
      "property char z\nelement face 1\nproperty list uchar uchar vertex_index\nend_header\n" +
          std::string("abc\x03\0\0\0", 7)};
  const auto parse = [](const std::string& text) {
    const PlyMesh mesh = parse_ply_mesh(text, "m.ply", 1e-3);
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t corner : triangle) {
        if (corner >= mesh.vertices.size()) throw std::logic_error("a corner beyond the vertices");
      }
    }
  };
  expect_sound_reports(fuzz(originals, 10000, 32, parse), 300);
}

}  // namespace
}  // namespace posemix
