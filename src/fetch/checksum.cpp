// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "checksum.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <openssl/evp.h>

#include "posemix/base/error.hpp"

namespace posemix {
namespace {

constexpr std::size_t kBlock = 1U << 18U;

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    check(context_ && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1);
  }

  void add(const char* data, std::size_t size) {
    check(EVP_DigestUpdate(context_.get(), data, size) == 1);
  }

  std::string digits() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> bytes{};
    unsigned int size = 0;
    check(EVP_DigestFinal_ex(context_.get(), bytes.data(), &size) == 1);
    std::string text;
    for (unsigned int i = 0; i < size; ++i) text += fmt::format("{:02x}", bytes[i]);
    return text;
  }

 private:
  static void check(bool done) {
    if (!done) throw std::runtime_error("OpenSSL cannot compute SHA-256");
  }

  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace

std::optional<FileContent> content_of_file(const std::filesystem::path& path,
                                           const ByteProgress& progress) {
  std::ifstream file(path, std::ios::binary);
  FileContent content;
  Sha256 hash;
  std::vector<char> block(kBlock);
  while (file) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    const auto count = static_cast<std::size_t>(file.gcount());
    hash.add(block.data(), count);
    content.size += count;
    if (progress && !progress(content.size)) return std::nullopt;
  }
  if (!file.eof()) {
    throw InvalidInput(fmt::format("{}: cannot be read: {}", path.string(), std::strerror(errno)));
  }
  content.sha256 = hash.digits();
  return content;
}

}  // namespace posemix
