// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "follow.hpp"

#include <algorithm>
#include <exception>
#include <thread>
#include <utility>

#include "messages.hpp"
#include "posemix/base/vector_instructions.hpp"
#include "schedule.hpp"
#include "work_pool.hpp"

namespace posemix {
namespace {

using Clock = std::chrono::steady_clock;
using Kind = RankMessageKind;

std::string message_of(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const std::exception& exception) {
    return exception.what();
  } catch (...) {
    return "an unknown error";
  }
}

/// Results on their way to rank 0, several in a message.
class Results {
 public:
  explicit Results(Ranks& ranks)
      : ranks_(ranks), wait_(time_between_messages(static_cast<std::size_t>(ranks.size()))) {}

  bool empty() const { return held_.items.empty() && !held_.error; }

  void add(FinishedBatch&& batch) {
    for (const FinishedItem& item : batch.items) bytes_ += item.text.size();
    held_.add(std::move(batch));
  }

  /// Whether it is time to send, where a rank whose threads may wait for more does so at once.
  bool due(bool runs_dry) const {
    constexpr std::size_t kMostBytes = 1 << 20;
    return !empty() && (runs_dry || held_.error || bytes_ > kMostBytes || Clock::now() >= next_);
  }

  void send() {
    if (!held_.items.empty()) {
      ranks_.send(0, Kind::results, held_.items.size(),
                  results_message(held_.items, held_.seconds));
    }
    if (held_.error) ranks_.send(0, Kind::error, 0, message_of(held_.error));
    held_ = {};
    bytes_ = 0;
    next_ = Clock::now() + wait_;
  }

 private:
  Ranks& ranks_;
  Clock::duration wait_;
  Clock::time_point next_ = Clock::now();
  FinishedBatch held_;
  std::size_t bytes_ = 0;
};

/// Sends results until rank 0 sends stop; then the results of the items in progress.
void work_for_leader(Ranks& ranks, WorkPool& pool) {
  Results results(ranks);
  bool stopped = false;
  while (!stopped || pool.outstanding() > 0 || !results.empty()) {
    FinishedBatch batch = pool.take(kPatience);
    if (batch.error) pool.cancel();
    results.add(std::move(batch));
    if (results.due(stopped || pool.runs_dry())) results.send();
    while (const auto message = ranks.receive()) {
      if (message->kind == Kind::items && !stopped) pool.submit(ranges_in(message->text));
      if (message->kind == Kind::stop) {
        stopped = true;
        pool.cancel();
      }
    }
  }
}

void wait_for_stop(Ranks& ranks) {
  while (true) {
    const auto message = ranks.receive();
    if (message && message->kind == Kind::stop) return;
    if (!message) std::this_thread::sleep_for(kPatience);
  }
}

}  // namespace

std::size_t threads_of(const Ranks& ranks, const StudyRunOptions& options) {
  if (options.threads > 0) return options.threads;
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  return std::max<std::size_t>(1, cores / static_cast<std::size_t>(ranks.on_host()));
}

Agreement Agreement::of(const std::string& text) {
  const std::size_t line = std::min(text.find('\n'), text.size());
  return {text.substr(0, line), text.substr(std::min(line + 1, text.size()))};
}

void follow(Ranks& ranks, const std::function<Study()>& make, const StudyRunOptions& options) {
  try {
    const Study study = make();
    WorkPool pool(threads_of(ranks, options), study.run_item);
    const Agreement ours{std::string(vector_instructions()), study.settings};
    ranks.send(0, Kind::hello, pool.threads(), ours.text());
    work_for_leader(ranks, pool);
  } catch (...) {
    ranks.send(0, Kind::error, 0, message_of(std::current_exception()));
    wait_for_stop(ranks);
  }
  ranks.send(0, Kind::bye);
}

}  // namespace posemix
