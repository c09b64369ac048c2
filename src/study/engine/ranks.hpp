// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace posemix {

/// What ranks say to each other.
enum class RankMessageKind : int { hello, item, result, error, stop, bye };

/// A message from another rank: a number and a text, which mean what the kind says.
struct RankMessage {
  int from;
  RankMessageKind kind;
  std::size_t number;
  std::string text;
};

/// The processes that work on one study.
///
/// A process that was started by `mpirun` (or another launcher that speaks PMI or PMIx) joins the
/// others through MPI; any other is alone, rank 0 of 1. All members are for one thread only. Lives
/// once in a process.
class Ranks {
 public:
  Ranks();
  /// Waits until all that was sent is delivered.
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  int rank() const;
  int size() const;
  /// How many ranks share this host, this one included.
  int on_host() const;

  /// Sends without waiting.
  void send(int to, RankMessageKind kind, std::size_t number = 0, std::string_view text = {});
  /// The next message, if one has arrived.
  std::optional<RankMessage> receive();

  /// Whether this build speaks MPI.
  static bool with_mpi();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace posemix
