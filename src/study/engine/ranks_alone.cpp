// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "ranks.hpp"

/// Ranks of a build without MPI.
namespace posemix {

class Ranks::Impl {};

Ranks::Ranks() = default;
Ranks::~Ranks() = default;

int Ranks::rank() const { return 0; }
int Ranks::size() const { return 1; }
int Ranks::on_host() const { return 1; }

void Ranks::send(int, RankMessageKind, std::size_t, std::string_view) {}
std::optional<RankMessage> Ranks::receive() { return std::nullopt; }

bool Ranks::with_mpi() { return false; }

}  // namespace posemix
