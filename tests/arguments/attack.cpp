// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "attack.hpp"

#include <cxxabi.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <memory>
#include <sstream>

namespace posemix::arguments {
namespace {

constexpr int kMostCrashes = 20;
/// Samples of each parameter that are tried where the first arguments are refused, and of each of
/// two.
constexpr std::size_t kTriedAlone = 40;
constexpr std::size_t kTriedInPairs = 12;

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

/// Arguments that may be fine: the first, and others in place of one or two of them.
std::vector<SampleNumbers> candidates(const SampleNumbers& counts) {
  std::vector<SampleNumbers> all{SampleNumbers(counts.size(), 0)};
  const auto with = [&](SampleNumbers arguments, std::size_t p, std::size_t i) {
    arguments[p] = i;
    all.push_back(arguments);
    return arguments;
  };
  for (std::size_t p = 0; p < counts.size(); ++p)
    for (std::size_t i = 1; i < std::min(counts[p], kTriedAlone); ++i) with(all[0], p, i);
  for (std::size_t p = 0; p < counts.size(); ++p) {
    for (std::size_t q = p + 1; q < counts.size(); ++q) {
      for (std::size_t i = 1; i < std::min(counts[p], kTriedInPairs); ++i) {
        SampleNumbers one = all[0];
        one[p] = i;
        for (std::size_t k = 1; k < std::min(counts[q], kTriedInPairs); ++k) with(one, q, k);
      }
    }
  }
  return all;
}

/// Where the calls of a function are: first one that is fine is looked for, then each of its
/// arguments is replaced.
struct Place {
  std::optional<std::size_t> base;  ///< the candidate that is fine
  std::size_t next = 0;             ///< the call to begin with
};

/// One process: calls from a place on, and tells the other end of a pipe.
class Attack {
 public:
  Attack(const Calls& calls, unsigned seconds, int pipe)
      : calls_(calls), seconds_(seconds), pipe_(pipe) {}

  void from(const Place& place) {
    const std::vector<SampleNumbers> tried = candidates(calls_.counts);
    std::size_t base = place.base.value_or(tried.size());
    for (std::size_t k = place.next; !place.base && base == tried.size() && k < tried.size(); ++k)
      if (does(fmt::format("tries {}", k), tried[k])) base = k;
    if (base == tried.size()) {
      tell("refuses " + refusal_);
      base = 0;
    }
    tell(fmt::format("base {}", base));
    std::size_t call = 0;
    for (std::size_t p = 0; p < calls_.counts.size(); ++p) {
      for (std::size_t i = 0; i < calls_.counts[p]; ++i, ++call) {
        if (place.base && call < place.next) continue;
        SampleNumbers arguments = tried[base];
        arguments[p] = i;
        does(fmt::format("calls {} argument {}: {}", call, p + 1, calls_.words[p](i)), arguments);
      }
    }
  }

 private:
  bool does(const std::string& what, const SampleNumbers& arguments) {
    tell(what);
    alarm(seconds_);
    try {
      calls_.call(arguments);
      return true;
    } catch (const std::exception& error) {
      if (!is_refusal(error)) tell("error " + word_of(error));
      if (refusal_.empty()) refusal_ = error.what();
      return false;
    }
  }
  void tell(std::string text) const {
    for (char& c : text)
      if (static_cast<unsigned char>(c) < ' ') c = ' ';
    text = text.substr(0, 400) + '\n';
    if (write(pipe_, text.data(), text.size()) != static_cast<ssize_t>(text.size())) _exit(1);
  }

  const Calls& calls_;
  unsigned seconds_;
  int pipe_;
  std::string refusal_;  ///< the first
};

std::string read_all(int pipe) {
  std::string text;
  std::array<char, 4096> buffer;
  for (ssize_t n = 0; (n = read(pipe, buffer.data(), buffer.size())) > 0;)
    text.append(buffer.data(), static_cast<std::size_t>(n));
  return text;
}

/// Takes what a process told; returns what its last call was, and moves the place behind it.
std::string take(const std::string& told, Place& place, Outcome& outcome) {
  std::string last;
  std::istringstream lines(told);
  std::string word;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    words >> word;
    const std::string rest = line.substr(std::min(word.size() + 1, line.size()));
    if (word == "error") {
      outcome.errors.push_back(last + ": " + rest);
    } else if (word == "refuses") {
      outcome.refuses_what_is_fine = rest;
    } else if (word == "base") {
      place = {.base = std::stoul(rest)};
    } else {
      place.next = std::stoul(rest) + 1;
      last = line;
    }
  }
  return last;
}

}  // namespace

std::vector<const Callee*>& callees() {
  static std::vector<const Callee*> all;
  return all;
}

Callee::Callee(std::string_view its_signature, std::function<std::optional<Calls>()> its_calls)
    : signature(its_signature), calls(std::move(its_calls)) {
  callees().push_back(this);
}

Outcome outcome_of(const Callee& callee, const std::filesystem::path& folder, unsigned seconds,
                   bool may_be_endless) {
  Outcome outcome;
  const std::optional<Calls> calls = callee.calls();
  outcome.is_called = calls.has_value();
  Place place;
  for (int crashes = 0; calls && crashes < kMostCrashes; ++crashes) {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) std::abort();
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child == 0) {
      close(ends[0]);
      if (chdir(folder.c_str()) != 0) _exit(1);
      Attack(*calls, seconds, ends[1]).from(place);
      _exit(0);
    }
    close(ends[1]);
    const std::string told = read_all(ends[0]);
    close(ends[0]);
    int status = 0;
    waitpid(child, &status, 0);
    const std::string last = take(told, place, outcome);
    if (status == 0) break;
    if (may_be_endless && WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM) continue;
    outcome.errors.push_back(fmt::format("{}: the process ended with the status {}", last, status));
  }
  return outcome;
}

}  // namespace posemix::arguments
