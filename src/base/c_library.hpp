// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <string>
#include <string_view>

/// The versions of exp, log, pow, sin, cos, atan2 and others of glibc on x86-64. It chooses those
/// with fused multiply-adds, whose last bits differ, by the features of the processor when a
/// process starts; the environment variable GLIBC_TUNABLES hides features from it.
namespace posemix::internal {

/// Whether the C library of this process fuses; nothing where it has one version for all
/// processors.
std::optional<bool> c_library_fuses();

struct CLibraryVersion {
  int major = 0;
  int minor = 0;
};

/// Whether glibc does not read GLIBC_TUNABLES in this process: one with more rights than its user.
bool c_library_ignores_tunables();

/// GLIBC_TUNABLES in the environment that a process was started with, as /proc/PID/environ has it:
/// glibc before 2.39 ends every assignment that it knows there with a NUL in place of the colon.
std::string tunables_in(const std::string& environment);

/// Whether a value of GLIBC_TUNABLES hides the feature from glibc of a version (2.36 is {2, 36}).
bool is_hidden(std::string_view tunables, std::string_view feature, CLibraryVersion version);

/// The value of GLIBC_TUNABLES that hides fused multiply-adds from glibc of any version, and keeps
/// what else `tunables` sets.
std::string tunables_without_fma(std::string_view tunables);

}  // namespace posemix::internal
