// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "data_server.hpp"
#include "fetch/checksum.hpp"
#include "run_program.hpp"

namespace posemix::testing {

inline bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// One file of 100 kB on a server, a registry with it, and a folder to fetch to.
class Data : public ::testing::Test {
 protected:
  void SetUp() override {
    for (int i = 0; i < 20000; ++i) content_ += fmt::format("{:04} ", i % 9999);
    server_.put("a b/file.txt", content_);
    sha256_ = content_of_file(folder_.put("original", content_))->sha256;
  }

  /// `more`: keys of the file beside its path.
  void use(const std::string& kind, const std::string& more) {
    folder_.put("sources.toml",
                fmt::format("schema = 1\n[[sources]]\nname = \"test\"\ntitle = \"A test\"\n"
                            "licence = \"CC0\"\nbase_url = \"{}\"\npublished_url = \"{}\"\n"
                            "files = [{{path = \"a b/file.txt\"{}}}]\n",
                            server_.url(kind), server_.url("plain") + "pointers/", more));
  }
  std::string pin() const {
    return fmt::format(", size = {}, sha256 = \"{}\"", content_.size(), sha256_);
  }
  std::vector<std::string> arguments(std::vector<std::string> more = {}) const {
    std::vector<std::string> all{"data",
                                 "fetch",
                                 "test",
                                 "--registry",
                                 (folder_ / "sources.toml").string(),
                                 "--out",
                                 (folder_ / "out").string(),
                                 "--retries",
                                 retries_};
    if (more.empty()) more = {"--yes"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  ProgramResult fetch(std::vector<std::string> more = {}) const {
    return run_posemix(arguments(std::move(more)));
  }
  std::filesystem::path target() const { return folder_ / "out/test/a b/file.txt"; }
  std::filesystem::path part() const { return target().string() + ".part"; }
  nlohmann::json lock() const {
    return nlohmann::json::parse(content_of(folder_ / "out/test/posemix-data.lock.json"));
  }

  DataServer server_;
  TemporaryFolder folder_;
  std::string content_;
  std::string sha256_;
  std::string retries_ = "0";
};

}  // namespace posemix::testing
