// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "checksum.hpp"
#include "download.hpp"
#include "posemix/base/error.hpp"
#include "unpack.hpp"

/// Downloads in a build without libcurl, OpenSSL and libarchive: every function throws.
namespace posemix {
namespace {

[[noreturn]] void refuse() {
  throw InvalidInput(
      "got a command that downloads or checks public data, expected a build with libcurl, OpenSSL "
      "and libarchive (POSEMIX_FETCH), which the wheels are without; the Debian package posemix "
      "has it");
}

}  // namespace

void check_can_fetch() { refuse(); }

struct Connection::Handle {};

Connection::Connection(const ConnectionSettings&) { refuse(); }
Connection::~Connection() = default;
bool Connection::get(const std::string&, const std::filesystem::path&,
                     const std::optional<std::uint64_t>&, const ByteProgress&) {
  refuse();
}
std::string Connection::get_text(const std::string&, const ByteProgress&) { refuse(); }

std::optional<FileContent> content_of_file(const std::filesystem::path&, const ByteProgress&) {
  refuse();
}

bool is_archive_name(const std::string&) { refuse(); }

std::optional<std::size_t> unpack_archive(const std::filesystem::path&,
                                          const std::filesystem::path&, const std::string&,
                                          const UnpackProgress&) {
  refuse();
}

}  // namespace posemix
