// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Containers cross between code with and without the address sanitizer, which would call the spare
// room of a vector an overflow. Leaks cannot be looked for where a debugger traces the test.
extern "C" const char* __asan_default_options();   // NOLINT(bugprone-reserved-identifier)
extern "C" const char* __asan_default_options() {  // NOLINT(bugprone-reserved-identifier)
  return "detect_leaks=0:detect_container_overflow=0";
}
extern "C" const char* __ubsan_default_options();   // NOLINT(bugprone-reserved-identifier)
extern "C" const char* __ubsan_default_options() {  // NOLINT(bugprone-reserved-identifier)
  return "print_stacktrace=1";
}
