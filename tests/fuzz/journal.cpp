// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/engine/journal.hpp"
#include "io/temporary_folder.hpp"
#include "posemix/io/output_folder.hpp"
#include "target.hpp"

/// Journals of studies that were interrupted: what is taken is continued, by one process at a time,
/// and is read again with what was added. Without --resume none that has items is taken.
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

/// Whether another one holds the journal.
bool is_locked(const std::filesystem::path& path, const Study& study) {
  try {
    const Journal other(path, study, true);
  } catch (const OutputError& error) {
    expect(std::string_view(error.what()).starts_with(path.string()), "an output elsewhere");
    return true;
  }
  return false;
}

void begin_anew(const std::filesystem::path& path, const Study& study) {
  takes(path.string(), [&] {
    expect(Journal(path, study, false).finished().empty(), "items that nobody asked for");
    expect(!std::filesystem::exists(path), "a journal without items is left behind");
  });
}

}  // namespace

POSEMIX_FUZZ_TARGET(journal) {
  static const posemix::testing::TemporaryFolder folder;
  const Study study = a_study();
  begin_anew(folder.put("journal.jsonl", bytes), study);
  const auto path = folder.put("journal.jsonl", bytes);
  takes(path.string(), [&] {
    std::map<std::size_t, std::string> finished;
    {
      Journal journal(path, study, true);
      finished = journal.finished();
      for (const auto& [item, text] : finished) expect(item < kItems, "an item that there is not");
      expect(is_locked(path, study), "two processes at one journal");
      const std::string result = "a \"text\"\n";
      journal.append(std::vector<FinishedItem>{{kItems - 1, result}});
      finished[kItems - 1] = result;
    }
    expect(Journal(path, study, true).finished() == finished, "another journal after writing");
  });
}

}  // namespace posemix::fuzzing
