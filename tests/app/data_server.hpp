// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <chrono>
#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>

#include <fmt/format.h>

#include "study/running_program.hpp"

namespace posemix::testing {

/// A local server of the files in a folder (data_server.py), which ends with its scope.
class DataServer {
 public:
  DataServer()
      : process_({POSEMIX_PYTHON, "-B", POSEMIX_SOURCE_DIR "/tests/app/data_server.py",
                  (folder_ / "files").string()},
                 (folder_ / "port").string()) {
    std::filesystem::create_directories(folder_ / "files");
    for (int i = 0; i < 1000 && port_.empty(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      const std::string text = content_of(folder_ / "port");
      if (text.ends_with('\n')) port_ = text.substr(0, text.size() - 1);
    }
    if (port_.empty()) throw std::runtime_error("the server does not start");
  }
  ~DataServer() {
    process_.send(SIGKILL);
    process_.wait();
  }

  void put(const std::string& name, const std::string& content) {
    folder_.put("files/" + name, content);
  }
  std::string url(const std::string& kind) const {
    return fmt::format("http://127.0.0.1:{}/{}/", port_, kind);
  }
  /// Every request so far: path and range.
  std::string requests() const { return content_of(folder_ / "requests"); }

 private:
  TemporaryFolder folder_;
  std::string port_;
  RunningProgram process_;
};

}  // namespace posemix::testing
