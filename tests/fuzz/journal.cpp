// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/engine/journal.hpp"
#include "io/temporary_folder.hpp"
#include "posemix/io/output_folder.hpp"
#include "target.hpp"

/// Journals of studies that were interrupted: what is taken is continued, and is read again with
/// what was added.
namespace posemix::fuzzing {
namespace {

constexpr std::size_t kItems = 20;

Study a_study() {
  Study study;
  study.name = "counting";
  study.settings = R"({"seed":1,"distribution":{"sd":0.1}})";
  study.items = kItems;
  return study;
}

}  // namespace

POSEMIX_FUZZ_TARGET(journal) {
  static const posemix::testing::TemporaryFolder folder;
  const auto path = folder.put("journal.jsonl", bytes);
  const Study study = a_study();
  takes(path.string(), [&] {
    std::map<std::size_t, std::string> finished;
    {
      Journal journal(path, study, true);
      finished = journal.finished();
      for (const auto& [item, text] : finished) expect(item < kItems, "an item that there is not");
      const std::string result = "a \"text\"\n";
      journal.append(std::vector<FinishedItem>{{kItems - 1, result}});
      finished[kItems - 1] = result;
    }
    expect(Journal(path, study, true).finished() == finished, "another journal after writing");
  });
}

}  // namespace posemix::fuzzing
