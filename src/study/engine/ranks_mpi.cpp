// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <list>

#include <mpi.h>

#include "ranks.hpp"

/// Ranks of a build with MPI.
namespace posemix {
namespace {

/// Whether a launcher of parallel programs started this process, by the environment variables of
/// Open MPI's mpirun, PMIx and PMI.
bool launched_in_parallel() {
  constexpr const char* kMarks[] = {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"};
  return std::any_of(std::begin(kMarks), std::end(kMarks),
                     [](const char* mark) { return std::getenv(mark) != nullptr; });
}

struct Outgoing {
  std::string bytes;
  MPI_Request request;
};

}  // namespace

class Ranks::Impl {
 public:
  Impl() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    MPI_Comm host;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank, MPI_INFO_NULL, &host);
    MPI_Comm_size(host, &on_host);
    MPI_Comm_free(&host);
  }

  ~Impl() {
    for (Outgoing& message : outgoing) MPI_Wait(&message.request, MPI_STATUS_IGNORE);
    MPI_Finalize();
  }

  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  /// Frees messages that have been delivered, up to the first that has not: rank 0 may have sent
  /// thousands.
  void tidy() {
    while (!outgoing.empty()) {
      int done = 0;
      MPI_Test(&outgoing.front().request, &done, MPI_STATUS_IGNORE);
      if (done == 0) return;
      outgoing.pop_front();
    }
  }

  int rank = 0;
  int size = 1;
  int on_host = 1;
  std::list<Outgoing> outgoing;
};

Ranks::Ranks() {
  if (launched_in_parallel()) impl_ = std::make_unique<Impl>();
}
Ranks::~Ranks() = default;

int Ranks::rank() const { return impl_ ? impl_->rank : 0; }
int Ranks::size() const { return impl_ ? impl_->size : 1; }
int Ranks::on_host() const { return impl_ ? impl_->on_host : 1; }

void Ranks::send(int to, RankMessageKind kind, std::size_t number, std::string_view text) {
  if (!impl_) return;
  const auto head = static_cast<std::uint64_t>(number);
  Outgoing& message = impl_->outgoing.emplace_back();
  message.bytes.resize(sizeof head);
  std::memcpy(message.bytes.data(), &head, sizeof head);
  message.bytes += text;
  MPI_Isend(message.bytes.data(), static_cast<int>(message.bytes.size()), MPI_BYTE, to,
            static_cast<int>(kind), MPI_COMM_WORLD, &message.request);
}

std::optional<RankMessage> Ranks::receive() {
  if (!impl_) return std::nullopt;
  impl_->tidy();
  int waiting = 0;
  MPI_Status status;
  MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &waiting, &status);
  if (waiting == 0) return std::nullopt;
  int length = 0;
  MPI_Get_count(&status, MPI_BYTE, &length);
  std::string bytes(static_cast<std::size_t>(length), '\0');
  MPI_Recv(bytes.data(), length, MPI_BYTE, status.MPI_SOURCE, status.MPI_TAG, MPI_COMM_WORLD,
           MPI_STATUS_IGNORE);
  std::uint64_t head = 0;
  std::memcpy(&head, bytes.data(), sizeof head);
  return RankMessage{status.MPI_SOURCE, static_cast<RankMessageKind>(status.MPI_TAG),
                     static_cast<std::size_t>(head), bytes.substr(sizeof head)};
}

bool Ranks::with_mpi() { return true; }

}  // namespace posemix
