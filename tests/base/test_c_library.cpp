// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "base/c_library.hpp"

#include <string>

#include <gtest/gtest.h>

/// The text of GLIBC_TUNABLES. Oracle: glibc's manual, "Tunables", and the names of its releases:
/// glibc.tune.hwcaps until 2.28, glibc.cpu.hwcaps since 2.29, features "..._Usable" until 2.32.
/// That glibc obeys is a test of the program (tests/app).
namespace posemix::internal {
namespace {

constexpr CLibraryVersion kDebian10{2, 28};
constexpr CLibraryVersion kDebian11{2, 31};
constexpr CLibraryVersion kDebian12{2, 36};

TEST(CLibrary, FeaturesAreHiddenByTheNamesOfItsVersion) {
  EXPECT_TRUE(is_hidden("glibc.cpu.hwcaps=-FMA", "FMA", kDebian12));
  EXPECT_TRUE(is_hidden("glibc.cpu.hwcaps=-FMA_Usable", "FMA", kDebian11));
  EXPECT_TRUE(is_hidden("glibc.tune.hwcaps=-FMA_Usable", "FMA", kDebian10));
  EXPECT_FALSE(is_hidden("glibc.cpu.hwcaps=-FMA_Usable", "FMA", kDebian12));
  EXPECT_FALSE(is_hidden("glibc.cpu.hwcaps=-FMA", "FMA", kDebian11));
  EXPECT_FALSE(is_hidden("glibc.cpu.hwcaps=-FMA_Usable", "FMA", kDebian10));
}

TEST(CLibrary, TheEnvironmentOfAProcessHasTunablesWholeAndInPieces) {
  const auto environment = [](const std::string& between) {
    using namespace std::string_literals;
    return "HOME=/\0GLIBC_TUNABLES=glibc.malloc.check=0"s + between +
           "glibc.cpu.hwcaps=-FMA\0A=1\0"s;
  };
  const std::string whole = "glibc.malloc.check=0:glibc.cpu.hwcaps=-FMA";
  EXPECT_EQ(tunables_in(environment(":")), whole);
  EXPECT_EQ(tunables_in(environment(std::string(1, '\0'))), whole);
  EXPECT_EQ(tunables_in("HOME=/"), "");
  EXPECT_EQ(tunables_in(""), "");
}

TEST(CLibrary, OnlyTheFeatureItselfIsHidden) {
  EXPECT_FALSE(is_hidden("", "FMA", kDebian12));
  EXPECT_FALSE(is_hidden("glibc.cpu.hwcaps=-FMA4", "FMA", kDebian12));
  EXPECT_FALSE(is_hidden("glibc.cpu.hwcaps=-FMA", "FMA4", kDebian12));
  EXPECT_FALSE(is_hidden("glibc.cpu.hwcaps=FMA", "FMA", kDebian12));
  EXPECT_FALSE(is_hidden("glibc.cpu.hwcaps_mask=-FMA", "FMA", kDebian12));
  EXPECT_FALSE(is_hidden("glibc.malloc.check=-FMA", "FMA", kDebian12));
  EXPECT_TRUE(is_hidden("glibc.cpu.hwcaps=-AVX2,-FMA,-ERMS", "FMA", kDebian12));
}

TEST(CLibrary, TheLastAssignmentOfATunableCounts) {
  EXPECT_FALSE(is_hidden("glibc.cpu.hwcaps=-FMA:glibc.cpu.hwcaps=-ERMS", "FMA", kDebian12));
  EXPECT_TRUE(is_hidden("glibc.cpu.hwcaps=-ERMS:glibc.cpu.hwcaps=-FMA", "FMA", kDebian12));
}

TEST(CLibrary, OneTextHidesFusedMultiplyAddsFromEveryVersion) {
  for (const std::string before :
       {"", ":", "glibc.malloc.check=3", "glibc.cpu.hwcaps=-ERMS", "glibc.tune.hwcaps=-ERMS",
        "glibc.cpu.hwcaps=-FMA", "glibc.cpu.hwcaps=:glibc.malloc.check=3"}) {
    SCOPED_TRACE(before);
    const std::string after = tunables_without_fma(before);
    for (const CLibraryVersion version : {kDebian10, kDebian11, kDebian12}) {
      EXPECT_TRUE(is_hidden(after, "FMA", version)) << after;
      EXPECT_TRUE(is_hidden(after, "FMA4", version)) << after;
    }
    // The program would otherwise start itself again without end.
    EXPECT_EQ(tunables_without_fma(after), after);
  }
}

TEST(CLibrary, OtherTunablesAndFeaturesAreKept) {
  const std::string after =
      tunables_without_fma("glibc.malloc.check=3:glibc.cpu.hwcaps=-ERMS:glibc.pthread.rseq=0");
  EXPECT_TRUE(after.starts_with("glibc.malloc.check=3:glibc.pthread.rseq=0:")) << after;
  EXPECT_TRUE(is_hidden(after, "ERMS", kDebian12)) << after;
}

TEST(CLibrary, AProcessWithoutMoreRightsThanItsUserObeysTunables) {
#if defined(__x86_64__) && defined(__GLIBC__)
  EXPECT_FALSE(c_library_ignores_tunables());
  EXPECT_TRUE(c_library_fuses().has_value());
#else
  EXPECT_FALSE(c_library_fuses().has_value());
#endif
}

}  // namespace
}  // namespace posemix::internal
