// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "invariants.hpp"
#include "posemix/detector/observation.hpp"
#include "posemix/io/observation_csv.hpp"
#include "posemix/io/observation_jsonl.hpp"
#include "target.hpp"

/// Observations as tables and as lines of JSON: what is taken is valid, and is read again alike in
/// both forms.
namespace posemix::fuzzing {
namespace {

void expect_same(const std::vector<Observation>& a, const std::vector<Observation>& b) {
  expect(a.size() == b.size(), "another number of observations after writing");
  for (std::size_t i = 0; i < a.size(); ++i) {
    expect(a[i].object == b[i].object && a[i].class_id == b[i].class_id &&
               a[i].camera == b[i].camera && a[i].detector == b[i].detector &&
               a[i].stamp_s == b[i].stamp_s && a[i].score == b[i].score &&
               a[i].components.size() == b[i].components.size(),
           "another observation after writing");
  }
}

}  // namespace

POSEMIX_FUZZ_TARGET(observations) {
  const Choice choice(bytes);
  takes("f", [&] {
    const auto read = choice.letter == 'j' ? parse_observation_lines(choice.rest, "f")
                                           : parse_observations(choice.rest, "f");
    for (const Observation& observation : read) validate(observation);
    expect_same(read, choice.letter == 'j'
                          ? parse_observation_lines(format_observation_lines(read), "again")
                          : parse_observations(format_observations(read), "again"));
  });
}

}  // namespace posemix::fuzzing
