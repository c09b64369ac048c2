// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "run_study.hpp"

#include <algorithm>
#include <chrono>
#include <deque>
#include <exception>
#include <memory>
#include <string_view>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "journal.hpp"
#include "posemix/base/error.hpp"
#include "work_pool.hpp"

namespace posemix {
namespace {

using Kind = RankMessageKind;

/// The time for which a rank waits for its own threads before it checks for messages.
constexpr std::chrono::milliseconds kPatience{1};

std::size_t threads_of(const Ranks& ranks, const StudyRunOptions& options) {
  if (options.threads > 0) return options.threads;
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  return std::max<std::size_t>(1, cores / static_cast<std::size_t>(ranks.on_host()));
}

/// State of another rank, as seen by rank 0.
struct Follower {
  std::size_t threads = 0;  ///< 0 until its first message
  std::size_t items = 0;    ///< items handed out and not finished
  bool gone = false;
};

/// Rank 0: hands out items and collects results.
class Leader {
 public:
  Leader(Ranks& ranks, const StudyRunOptions& options)
      : ranks_(ranks), options_(options), followers_(static_cast<std::size_t>(ranks.size())) {}

  /// In all cases, items in progress are kept and no rank is left waiting.
  ~Leader() {
    collect_running();
    dismiss();
  }

  Leader(const Leader&) = delete;
  Leader& operator=(const Leader&) = delete;

  StudyRun lead(const std::function<Study()>& make) {
    StudyRun run{make(), {}, false};
    begin(run.study);
    while (done_ < run.study.items) {
      hand_out();
      for (WorkResult& result : pool_->take(kPatience)) {
        if (result.error) std::rethrow_exception(result.error);
        accept(result.item, std::move(result.text));
      }
      while (auto message = ranks_.receive()) handle(std::move(*message));
      if (!go_on()) return run;
    }
    run.results = std::move(results_);
    run.complete = true;
    return run;
  }

 private:
  void begin(const Study& study) {
    settings_ = study.settings;
    results_.resize(study.items);
    std::vector<bool> finished(study.items, false);
    if (!options_.journal.empty()) {
      journal_ = std::make_unique<Journal>(options_.journal, study, options_.resume);
      for (const auto& [item, text] : journal_->finished()) {
        results_[item] = text;
        finished[item] = true;
        ++done_;
      }
    }
    for (std::size_t item = 0; item < study.items; ++item) {
      if (!finished[item]) waiting_.push_back(item);
    }
    pool_ = std::make_unique<WorkPool>(threads_of(ranks_, options_), study.run_item);
  }

  bool go_on() const { return !options_.progress || options_.progress(done_, results_.size()); }

  /// Submits items to every thread and one more, so that no thread waits.
  void hand_out() {
    while (!waiting_.empty() && pool_->outstanding() < pool_->threads() + 1) {
      pool_->submit(waiting_.front());
      waiting_.pop_front();
    }
    for (std::size_t rank = 1; rank < followers_.size(); ++rank) {
      Follower& follower = followers_[rank];
      while (!waiting_.empty() && follower.threads > 0 && follower.items < follower.threads + 1) {
        ranks_.send(static_cast<int>(rank), Kind::item, waiting_.front());
        waiting_.pop_front();
        ++follower.items;
      }
    }
  }

  void accept(std::size_t item, std::string text) {
    if (journal_) journal_->append(item, text);
    results_[item] = std::move(text);
    ++done_;
  }

  void handle(RankMessage message) {
    Follower& follower = followers_[static_cast<std::size_t>(message.from)];
    switch (message.kind) {
      case Kind::hello:
        if (message.text != settings_) {
          throw InvalidInput(fmt::format("rank {} has other settings than rank 0", message.from));
        }
        follower.threads = message.number;
        return;
      case Kind::result:
        --follower.items;
        return accept(message.number, std::move(message.text));
      case Kind::error:
        throw InvalidInput(fmt::format("rank {}: {}", message.from, message.text));
      case Kind::bye:
        follower.gone = true;
        return;
      case Kind::item:
      case Kind::stop:
        return;
    }
  }

  /// Keeps a result after the end. A journal that cannot be written was reported before.
  void keep(std::size_t item, std::string_view text) noexcept {
    try {
      if (journal_) journal_->append(item, text);
    } catch (const std::exception&) {
      journal_.reset();
    }
  }

  /// Waits for the items in progress on this rank; begins no new one.
  void collect_running() noexcept {
    if (!pool_) return;
    pool_->cancel();
    while (pool_->outstanding() > 0) {
      for (const WorkResult& result : pool_->take(kPatience)) {
        if (!result.error) keep(result.item, result.text);
      }
    }
  }

  /// Stops the other ranks, and keeps the results that they finish until then.
  void dismiss() noexcept {
    for (std::size_t rank = 1; rank < followers_.size(); ++rank) {
      ranks_.send(static_cast<int>(rank), Kind::stop);
    }
    const auto there = [](const Follower& follower) { return !follower.gone; };
    while (std::any_of(followers_.begin() + 1, followers_.end(), there)) {
      const auto message = ranks_.receive();
      if (!message) {
        std::this_thread::sleep_for(kPatience);
        continue;
      }
      if (message->kind == Kind::result) keep(message->number, message->text);
      if (message->kind == Kind::bye) {
        followers_[static_cast<std::size_t>(message->from)].gone = true;
      }
    }
  }

  Ranks& ranks_;
  const StudyRunOptions& options_;
  std::vector<Follower> followers_;
  std::string settings_;
  std::deque<std::size_t> waiting_;
  std::vector<std::string> results_;
  std::size_t done_ = 0;
  std::unique_ptr<Journal> journal_;
  std::unique_ptr<WorkPool> pool_;
};

std::string message_of(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const std::exception& exception) {
    return exception.what();
  } catch (...) {
    return "an unknown error";
  }
}

/// Sends results until rank 0 sends stop; then the results of the items in progress.
void work_for_leader(Ranks& ranks, WorkPool& pool) {
  bool stopped = false;
  while (!stopped || pool.outstanding() > 0) {
    for (WorkResult& result : pool.take(kPatience)) {
      if (result.error) {
        ranks.send(0, Kind::error, result.item, message_of(result.error));
      } else {
        ranks.send(0, Kind::result, result.item, result.text);
      }
    }
    while (const auto message = ranks.receive()) {
      if (message->kind == Kind::item) pool.submit(message->number);
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

/// The work of any rank but rank 0.
void follow(Ranks& ranks, const std::function<Study()>& make, const StudyRunOptions& options) {
  try {
    const Study study = make();
    WorkPool pool(threads_of(ranks, options), study.run_item);
    ranks.send(0, Kind::hello, pool.threads(), study.settings);
    work_for_leader(ranks, pool);
  } catch (...) {
    ranks.send(0, Kind::error, 0, message_of(std::current_exception()));
    wait_for_stop(ranks);
  }
  ranks.send(0, Kind::bye);
}

}  // namespace

std::optional<StudyRun> run_study(Ranks& ranks, const std::function<Study()>& make,
                                  const StudyRunOptions& options) {
  if (ranks.rank() == 0) return Leader(ranks, options).lead(make);
  follow(ranks, make, options);
  return std::nullopt;
}

}  // namespace posemix
