// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "attack.hpp"

#include <cxxabi.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <memory>
#include <sstream>

namespace posemix::arguments {
namespace {

constexpr int kMostCrashes = 20;

void send(int pipe, const std::string& line) {
  if (write(pipe, line.data(), line.size()) != static_cast<ssize_t>(line.size())) _exit(1);
}

std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return text.substr(0, 400);
}

/// Calls the function in this process, and tells the other end of the pipe.
void attack_and_tell(const Callee& callee, std::size_t first, unsigned seconds, int pipe) {
  Report report;
  report.first = first;
  report.begins = [&](const std::string& what) {
    alarm(seconds);
    send(pipe, fmt::format("begins {} {}\n", report.calls, one_line(what)));
  };
  callee.attack(report);
  for (const std::string& error : report.errors) send(pipe, "error " + one_line(error) + "\n");
  if (!report.is_called) send(pipe, "uncalled\n");
  if (!report.fine_message.empty()) send(pipe, "refuses " + one_line(report.fine_message) + "\n");
  send(pipe, fmt::format("calls {}\n", report.returned + report.refused));
}

std::string read_all(int pipe) {
  std::string text;
  std::array<char, 4096> buffer;
  for (ssize_t n = 0; (n = read(pipe, buffer.data(), buffer.size())) > 0;)
    text.append(buffer.data(), static_cast<std::size_t>(n));
  return text;
}

/// Takes what a process told; returns the number of its last call.
std::size_t take(const std::string& told, Outcome& outcome, std::string& last) {
  std::size_t call = 0;
  std::istringstream lines(told);
  for (std::string line; std::getline(lines, line);) {
    const std::string_view text = line;
    const std::string rest(text.substr(std::min(text.find(' '), text.size() - 1) + 1));
    if (text.starts_with("begins ")) {
      call = std::stoul(rest);
      last = rest.substr(rest.find(' ') + 1);
    } else if (text.starts_with("error ")) {
      outcome.errors.push_back(rest);
    } else if (text == "uncalled") {
      outcome.is_called = false;
    } else if (text.starts_with("refuses ")) {
      outcome.refuses_what_is_fine = rest;
    } else if (text.starts_with("calls ")) {
      outcome.calls += std::stoul(rest);
    }
  }
  return call;
}

}  // namespace

std::vector<const Callee*>& callees() {
  static std::vector<const Callee*> all;
  return all;
}

Callee::Callee(std::string_view its_signature, std::function<void(Report&)> its_attack)
    : signature(its_signature), attack(std::move(its_attack)) {
  callees().push_back(this);
}

std::string word_of(const std::exception& error) {
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> name(
      abi::__cxa_demangle(typeid(error).name(), nullptr, nullptr, &status), std::free);
  return fmt::format("{}: {}", name.get(), error.what());
}

bool is_refusal(const std::exception& error) {
  return dynamic_cast<const InvalidInput*>(&error) != nullptr ||
         dynamic_cast<const OutputError*>(&error) != nullptr;
}

Outcome outcome_of(const Callee& callee, const std::string& folder, unsigned seconds,
                   bool may_be_endless) {
  Outcome outcome;
  std::size_t first = 0;
  for (int crashes = 0; crashes < kMostCrashes; ++crashes) {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) std::abort();
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child == 0) {
      close(ends[0]);
      if (chdir(folder.c_str()) != 0) _exit(1);
      attack_and_tell(callee, first, seconds, ends[1]);
      _exit(0);
    }
    close(ends[1]);
    const std::string told = read_all(ends[0]);
    close(ends[0]);
    int status = 0;
    waitpid(child, &status, 0);
    std::string last;
    first = take(told, outcome, last);
    if (status == 0) break;
    if (may_be_endless && WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM) continue;
    outcome.errors.push_back(fmt::format("{}: the process ended with the status {}", last, status));
  }
  return outcome;
}

}  // namespace posemix::arguments
