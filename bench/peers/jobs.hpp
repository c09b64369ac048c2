// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

/// What the programs of one comparison share. Every program does the same jobs on the same numbers
/// and writes what it found, so that the results can be compared. This header needs the standard
/// library alone: a program of a peer must not see any other part of the library.
///
///   PROGRAM INPUTS RESULTS SECONDS [JOB]...
///
/// INPUTS has one file of doubles per array, RESULTS gets one per job. For every job a line of JSON
/// is printed with the processor's time of each sample in seconds per item. SECONDS is how long a
/// job is measured; with 0 it is done once, and no time is printed.
namespace bench {

/// Stops the compiler from leaving out the computation of `value`.
template <class T>
void keep(const T& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

/// The time of this thread's processor [s]: other programs on the machine do not count.
inline double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

class Jobs {
 public:
  Jobs(int count, char** arguments) {
    if (count < 4) throw std::invalid_argument("expected: INPUTS RESULTS SECONDS [JOB]...");
    inputs_ = arguments[1];
    results_ = arguments[2];
    seconds_ = std::strtod(arguments[3], nullptr);
    chosen_.assign(arguments + 4, arguments + count);
  }

  /// Whether the job is to be done.
  bool wants(const std::string& job) const {
    return chosen_.empty() || std::find(chosen_.begin(), chosen_.end(), job) != chosen_.end();
  }

  /// The doubles of an array that all programs read.
  std::vector<double> input(const std::string& name) const {
    const std::string path = inputs_ + "/" + name + ".f64";
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) throw std::runtime_error("cannot read " + path);
    std::vector<double> values(static_cast<std::size_t>(file.tellg()) / sizeof(double));
    file.seekg(0);
    file.read(reinterpret_cast<char*>(values.data()),
              static_cast<std::streamsize>(values.size() * sizeof(double)));
    return values;
  }

  /// Measures `work`, one call of which is `items` items, and writes what `output` returns.
  template <class Work, class Output>
  void run(const std::string& job, std::size_t items, const Work& work, const Output& output) {
    if (!wants(job)) return;
    if (seconds_ > 0) {
      write(job, samples(work, static_cast<double>(items)));
    } else {
      work();
    }
    const std::vector<double> found = output();
    std::ofstream file(results_ + "/" + job + ".f64", std::ios::binary);
    file.write(reinterpret_cast<const char*>(found.data()),
               static_cast<std::streamsize>(found.size() * sizeof(double)));
    if (!file) throw std::runtime_error("cannot write the results of " + job);
  }

 private:
  static constexpr int kSamples = 9;

  static double seconds_of(double calls, const auto& work) {
    const double begin = processor_seconds();
    for (double i = 0; i < calls; ++i) work();
    return processor_seconds() - begin;
  }

  /// Seconds per item of samples that take a part of the time each; the first calls warm up. Work
  /// that takes long has fewer samples, at least the first.
  std::vector<double> samples(const auto& work, double items) const {
    const double share = seconds_ / kSamples;
    double calls = 1;
    double took = seconds_of(calls, work);
    if (took > seconds_) return {took / items};
    while (took < 0.25 * share) {
      calls *= 2;
      took = seconds_of(calls, work);
    }
    calls = std::max(1.0, std::floor(share / took * calls));
    const int count = std::clamp(static_cast<int>(seconds_ / took), 3, kSamples);
    std::vector<double> result;
    for (int i = 0; i < count; ++i) result.push_back(seconds_of(calls, work) / (calls * items));
    return result;
  }

  static void write(const std::string& job, const std::vector<double>& samples) {
    std::cout << "{\"job\": \"" << job << "\", \"seconds\": [";
    for (std::size_t i = 0; i < samples.size(); ++i) std::cout << (i ? ", " : "") << samples[i];
    std::cout << "]}\n" << std::flush;
  }

  std::string inputs_;
  std::string results_;
  double seconds_ = 0.0;
  std::vector<std::string> chosen_;
};

/// Runs `one` for each of as many items as `found` has, which gets what it returns.
template <class Found, class One, class Output>
void run_each(Jobs& jobs, const std::string& job, std::vector<Found>& found, const One& one,
              const Output& output) {
  const auto work = [&] {
    for (std::size_t i = 0; i < found.size(); ++i) found[i] = one(i);
    keep(found);
  };
  jobs.run(job, found.size(), work, [&] { return output(found); });
}

/// The body of main: runs `all`, and says what went wrong.
template <class All>
int jobs_main(int count, char** arguments, const All& all) {
  try {
    Jobs jobs(count, arguments);
    all(jobs);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << arguments[0] << ": " << error.what() << '\n';
    return 1;
  }
}

}  // namespace bench
