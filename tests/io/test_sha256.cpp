// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "io/sha256.hpp"

#include <gtest/gtest.h>

#include "expect_invalid.hpp"
#include "temporary_folder.hpp"

namespace posemix {
namespace {

using internal::Sha256;
using internal::sha256_of;

// FIPS 180-4 and NIST's examples.
constexpr const char* kOfNothing =
    "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
constexpr const char* kOfMillion =
    "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0";

TEST(Sha256, OfPublishedTexts) {
  EXPECT_EQ(sha256_of(""), kOfNothing);
  EXPECT_EQ(sha256_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256_of(std::string(1000000, 'a')), kOfMillion);
}

TEST(Sha256, DoesNotDependOnThePieces) {
  for (const std::size_t piece : {1U, 55U, 63U, 64U, 65U, 1000U}) {
    Sha256 hash;
    for (std::size_t done = 0; done < 1000000; done += piece)
      hash.add(std::string(std::min<std::size_t>(piece, 1000000 - done), 'a'));
    EXPECT_EQ(hash.digits(), kOfMillion) << piece;
  }
}

TEST(Sha256, OfAFile) {
  const testing::TemporaryFolder folder;
  EXPECT_EQ(internal::sha256_of_file(folder.put("a", std::string(1000000, 'a'))), kOfMillion);
  EXPECT_EQ(internal::sha256_of_file(folder.put("b", "")), kOfNothing);
  EXPECT_INVALID_WITH(internal::sha256_of_file(folder / "none"), "none: cannot be read");
}

}  // namespace
}  // namespace posemix
