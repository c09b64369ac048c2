// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "run_study.hpp"

#include <algorithm>
#include <exception>
#include <memory>
#include <span>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "follow.hpp"
#include "journal.hpp"
#include "messages.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/vector_instructions.hpp"
#include "schedule.hpp"
#include "work_pool.hpp"

namespace posemix {
namespace {

using Kind = RankMessageKind;

/// Rank 0: hands out items and collects results.
class Leader {
 public:
  Leader(Ranks& ranks, const StudyRunOptions& options)
      : ranks_(ranks), options_(options), gone_(static_cast<std::size_t>(ranks.size()), false) {
    gone_[0] = true;  // rank 0 does not wait for itself
  }

  /// In all cases, items in progress are kept and no rank is left waiting.
  ~Leader() {
    collect_running();
    dismiss();
  }

  Leader(const Leader&) = delete;
  Leader& operator=(const Leader&) = delete;

  StudyRun lead(const std::function<Study()>& make) {
    StudyRun run{make(), {}, false, {}};
    begin(run.study);
    while (done_ < run.study.items) {
      hand_out(0);
      accept(0, pool_->take(kPatience));
      while (const auto message = ranks_.receive()) handle(*message);
      if (!go_on()) return run;
    }
    run.instructions = journal_ ? journal_->instructions() : ours_.instructions;
    run.results = std::move(results_);
    run.complete = true;
    return run;
  }

 private:
  void begin(const Study& study) {
    ours_ = {std::string(vector_instructions()), study.settings};
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
    schedule_ = std::make_unique<Schedule>(finished, gone_.size());
    pool_ = std::make_unique<WorkPool>(threads_of(ranks_, options_), study.run_item);
    schedule_->join(0, pool_->threads());
  }

  bool go_on() const { return !options_.progress || options_.progress(done_, results_.size()); }

  /// Gives a rank what it is to get now.
  void hand_out(std::size_t rank) {
    const std::vector<ItemRange> ranges = schedule_->next(rank);
    if (ranges.empty()) return;
    if (rank == 0) return pool_->submit(ranges);
    ranks_.send(static_cast<int>(rank), Kind::items, ranges.size(), ranges_message(ranges));
  }

  void accept(std::size_t rank, FinishedBatch&& batch) {
    if (journal_) journal_->append(batch.items);
    for (FinishedItem& item : batch.items) results_.at(item.item) = std::move(item.text);
    done_ += batch.items.size();
    schedule_->finished(rank, batch.items.size(), batch.seconds);
    if (batch.error) std::rethrow_exception(batch.error);
  }

  void handle(const RankMessage& message) {
    const auto rank = static_cast<std::size_t>(message.from);
    switch (message.kind) {
      case Kind::hello:
        check(message.from, Agreement::of(message.text));
        schedule_->join(rank, message.number);
        return hand_out(rank);
      case Kind::results:
        accept(rank, results_in(message.text));
        return hand_out(rank);
      case Kind::error:
        throw InvalidInput(fmt::format("rank {}: {}", message.from, message.text));
      case Kind::bye:
        gone_[rank] = true;
        return;
      case Kind::items:
      case Kind::stop:
        return;
    }
  }

  void check(int rank, const Agreement& theirs) const {
    if (theirs.instructions != ours_.instructions) {
      throw InvalidInput(fmt::format(
          "rank {} has the vector instructions {}, rank 0 has {}, and the last bits of results "
          "would "
          "depend on who works on what; set POSEMIX_SIMD=portable for all ranks (mpirun -x "
          "POSEMIX_SIMD=portable), or a set that all machines have",
          rank, theirs.instructions, ours_.instructions));
    }
    if (theirs.settings != ours_.settings)
      throw InvalidInput(fmt::format("rank {} has other settings than rank 0", rank));
  }

  /// Keeps results after the end. A journal that cannot be written was reported before.
  void keep(std::span<const FinishedItem> items) noexcept {
    try {
      if (journal_) journal_->append(items);
    } catch (const std::exception&) {
      journal_.reset();
    }
  }
  /// The same for those of a message, unless it is cut off.
  void keep(std::string_view message) noexcept {
    try {
      keep(results_in(message).items);
    } catch (const std::exception&) {
      return;
    }
  }

  /// Waits for the items in progress on this rank; begins no new one.
  void collect_running() noexcept {
    if (!pool_) return;
    pool_->cancel();
    while (pool_->outstanding() > 0) keep(pool_->take(kPatience).items);
  }

  /// Stops the other ranks, and keeps the results that they finish until then.
  void dismiss() noexcept {
    for (std::size_t rank = 1; rank < gone_.size(); ++rank)
      ranks_.send(static_cast<int>(rank), Kind::stop);
    auto left = std::count(gone_.begin(), gone_.end(), false);
    while (left > 0) {
      const auto message = ranks_.receive();
      if (!message) {
        std::this_thread::sleep_for(kPatience);
        continue;
      }
      if (message->kind == Kind::results) keep(message->text);
      if (message->kind == Kind::bye) --left;
    }
  }

  Ranks& ranks_;
  const StudyRunOptions& options_;
  std::vector<bool> gone_;  ///< ranks that have said goodbye
  Agreement ours_;
  std::vector<std::string> results_;
  std::size_t done_ = 0;
  std::unique_ptr<Journal> journal_;
  std::unique_ptr<Schedule> schedule_;
  std::unique_ptr<WorkPool> pool_;
};

}  // namespace

std::optional<StudyRun> run_study(Ranks& ranks, const std::function<Study()>& make,
                                  const StudyRunOptions& options) {
  if (ranks.rank() == 0) return Leader(ranks, options).lead(make);
  follow(ranks, make, options);
  return std::nullopt;
}

}  // namespace posemix
