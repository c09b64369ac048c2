// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <csignal>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/temporary_folder.hpp"

namespace posemix::testing {

/// Results of a run of the program.
struct ProgramResult {
  int exit_code;  ///< 128 plus the signal's number if a signal ended it
  std::string out;
  std::string err;
};

/// A started program whose standard output and error go to files.
class RunningProgram {
 public:
  /// `command` is a path and arguments. `out` names a file for the standard output, which is then
  /// not part of the result.
  explicit RunningProgram(const std::vector<std::string>& command, const std::string& out = {})
      : out_(out.empty() ? (folder_ / "out").string() : out), err_((folder_ / "err").string()) {
    std::vector<char*> arguments;
    for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    pid_ = fork();
    if (pid_ < 0) throw std::runtime_error("cannot fork");
    if (pid_ == 0) {
      // A shell without job control has what it starts in the background ignore it.
      std::signal(SIGINT, SIG_DFL);
      redirect(out_, STDOUT_FILENO);
      redirect(err_, STDERR_FILENO);
      execv(arguments[0], arguments.data());
      _exit(127);
    }
  }
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  void send(int signal) const { kill(pid_, signal); }

  bool has_ended() {
    if (!ended_) ended_ = waitpid(pid_, &status_, WNOHANG) == pid_;
    return ended_;
  }

  ProgramResult wait() {
    if (!ended_) waitpid(pid_, &status_, 0);
    ended_ = true;
    const int code = WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
    const bool own = out_.starts_with(folder_.path().string());
    return {code, own ? content_of(out_) : std::string(), content_of(err_)};
  }

 private:
  static void redirect(const std::string& path, int descriptor) {
    const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (file < 0 || dup2(file, descriptor) < 0) _exit(126);
  }

  TemporaryFolder folder_;
  std::string out_;
  std::string err_;
  pid_t pid_;
  int status_ = 0;
  bool ended_ = false;
};

}  // namespace posemix::testing
