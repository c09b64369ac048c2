// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace posemix {

/// Kinds of messages between ranks.
enum class RankMessageKind : int { hello, items, results, error, stop, bye };

/// A message from another rank. The kind determines the meaning of number and text.
struct RankMessage {
  int from;
  RankMessageKind kind;
  std::size_t number;
  std::string text;
};

/// The processes that work on one study.
///
/// A process that was started by `mpirun` (or another launcher with PMI or PMIx) joins the others
/// through MPI; any other process is rank 0 of 1. All members must be called from one thread. A
/// process has at most one object of this class.
class Ranks {
 public:
  Ranks();
  /// Waits until all sent messages are delivered.
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  int rank() const;
  int size() const;
  /// The number of ranks on this host, this one included.
  int on_host() const;

  /// Sends without waiting.
  void send(int to, RankMessageKind kind, std::size_t number = 0, std::string_view text = {});
  /// The next message, if one has arrived.
  std::optional<RankMessage> receive();

  /// Whether this build has MPI.
  static bool with_mpi();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace posemix
