// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
//
// A library for LD_PRELOAD that counts the calls by which a program changes files below a folder,
// and disturbs one of them. The environment says how:
//
//   POSEMIX_FAULT_BELOW=FOLDER    the folder; calls on other files, and on what is no file, are
//   left alone POSEMIX_FAULT_LOG=FILE        gets a line "number call" for every call that is
//   counted POSEMIX_FAULT=kill N          SIGKILL before the N-th call
//                 torn N          the same, when a write has got half of its bytes into the file
//                 fail N ERRNO    the N-th call fails with this error
//                 full N          from the N-th call on the disk is full: what needs room fails
//                 with ENOSPC, the first
//                                 write after half of its bytes
//                 rough           every call that may be is interrupted (EINTR) once, and every
//                 write is short
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace {

enum class Mode { count, kill, torn, fail, full, rough };

struct Plan {
  Plan() {
    if (const char* text = std::getenv("POSEMIX_FAULT_BELOW")) below = text;
    if (const char* text = std::getenv("POSEMIX_FAULT_LOG"))
      log = static_cast<int>(
          ::syscall(SYS_openat, AT_FDCWD, text, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
    const char* text = std::getenv("POSEMIX_FAULT");
    char word[8] = {};
    if (text == nullptr || std::sscanf(text, "%7s %ld %d", word, &at, &error) < 1) return;
    const std::string_view name = word;
    mode = name == "kill"   ? Mode::kill
           : name == "torn" ? Mode::torn
           : name == "fail" ? Mode::fail
           : name == "full" ? Mode::full
                            : Mode::rough;
  }

  std::string below;
  int log = -1;
  Mode mode = Mode::count;
  long at = 0;
  int error = 0;
};

const Plan& plan() {
  static const Plan made;
  return made;
}

std::atomic<long> calls = 0;

/// What a call needs beside its arguments.
enum class Needs { nothing, room };

bool is_below(std::string_view path) {
  const std::string& folder = plan().below;
  return !folder.empty() && path.starts_with(folder) &&
         (path.size() == folder.size() || path[folder.size()] == '/');
}

bool counts(int folder, const char* path) {
  if (path == nullptr) return false;
  if (*path == '/') return is_below(path);
  char link[64];
  char base[PATH_MAX] = {};
  if (folder == AT_FDCWD) {
    if (::getcwd(base, sizeof base) == nullptr) return false;
  } else {
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", folder);
    if (::readlink(link, base, sizeof base - 1) < 0) return false;
  }
  return is_below(std::string(base) + "/" + path);
}

bool counts(int file) {
  if (file == plan().log) return false;
  char link[64];
  char path[PATH_MAX] = {};
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const int before = errno;
  const bool known = ::readlink(link, path, sizeof path - 1) > 0;
  errno = before;
  return known && is_below(path);
}

void note(long number, const char* call) {
  char line[64];
  const int size = std::snprintf(line, sizeof line, "%ld %s\n", number, call);
  if (plan().log >= 0) ::syscall(SYS_write, plan().log, line, static_cast<std::size_t>(size));
}

[[noreturn]] void die() {
  ::kill(::getpid(), SIGKILL);
  while (true) ::pause();
}

/// Counts a call and does what is planned for it; true if it is to fail, with errno set.
bool is_to_fail(const char* call, Needs needs, long number) {
  const Plan& now = plan();
  note(number, call);
  if (number == now.at && (now.mode == Mode::kill || now.mode == Mode::torn)) die();
  if (number == now.at && now.mode == Mode::fail) return errno = now.error, true;
  if (number >= now.at && now.mode == Mode::full && needs == Needs::room)
    return errno = ENOSPC, true;
  return false;
}

/// Whether a call that a signal may interrupt is to be, every second time.
bool is_interrupted() {
  thread_local bool last = false;
  if (plan().mode != Mode::rough) return false;
  last = !last;
  if (last) errno = EINTR;
  return last;
}

template <typename Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

/// A write by `done(size)`, which writes the first bytes.
template <typename Done>
ssize_t disturbed_write(std::size_t size, const Done& done) {
  const Plan& now = plan();
  const long number = ++calls;
  const bool here = number == now.at;
  if (here && now.mode == Mode::torn) done(size / 2);
  if (here && now.mode == Mode::full && size > 1) {
    note(number, "write");
    return done(size / 2);
  }
  if (is_to_fail("write", Needs::room, number) || is_interrupted()) return -1;
  return done(now.mode == Mode::rough && size > 1 ? (size + 1) / 2 : size);
}

bool changes(int flags) { return (flags & (O_CREAT | O_TRUNC)) != 0 || (flags & O_ACCMODE) != 0; }

}  // namespace

extern "C" {

ssize_t write(int file, const void* bytes, std::size_t size) {
  const auto done = [&](std::size_t first) {
    return static_cast<ssize_t>(::syscall(SYS_write, file, bytes, first));
  };
  return counts(file) ? disturbed_write(size, done) : done(size);
}

ssize_t pwrite64(int file, const void* bytes, std::size_t size, off64_t place) {
  const auto done = [&](std::size_t first) {
    return static_cast<ssize_t>(::syscall(SYS_pwrite64, file, bytes, first, place));
  };
  return counts(file) ? disturbed_write(size, done) : done(size);
}
ssize_t pwrite(int file, const void* bytes, std::size_t size, off_t place) {
  return pwrite64(file, bytes, size, place);
}

int openat64(int folder, const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const bool has_mode = (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE;
  const mode_t mode = has_mode ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  if (changes(flags) && counts(folder, path)) {
    const Needs needs = has_mode ? Needs::room : Needs::nothing;
    if (is_to_fail("open", needs, ++calls) || is_interrupted()) return -1;
  }
  return static_cast<int>(::syscall(SYS_openat, folder, path, flags, mode));
}
int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const bool has_mode = (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE;
  const mode_t mode = has_mode ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  return openat64(AT_FDCWD, path, flags, mode);
}
int open(const char* path, int flags, ...) __attribute__((alias("open64")));
int openat(int folder, const char* path, int flags, ...) __attribute__((alias("openat64")));
// What <fcntl.h> calls where flags are checked.
int __open64_2(const char* path, int flags) { return openat64(AT_FDCWD, path, flags); }
int __open_2(const char* path, int flags) { return openat64(AT_FDCWD, path, flags); }

int fsync(int file) {
  if (counts(file) && (is_to_fail("fsync", Needs::nothing, ++calls) || is_interrupted())) return -1;
  return real<int(int)>("fsync")(file);
}

int ftruncate64(int file, off64_t size) {
  if (counts(file) && (is_to_fail("ftruncate", Needs::nothing, ++calls) || is_interrupted()))
    return -1;
  return static_cast<int>(::syscall(SYS_ftruncate, file, size));
}
int ftruncate(int file, off_t size) { return ftruncate64(file, size); }

int flock(int file, int operation) {
  if (counts(file) && is_to_fail("flock", Needs::nothing, ++calls)) return -1;
  return real<int(int, int)>("flock")(file, operation);
}

int link(const char* from, const char* to) {
  if (counts(AT_FDCWD, to) && is_to_fail("link", Needs::room, ++calls)) return -1;
  return real<int(const char*, const char*)>("link")(from, to);
}

int rename(const char* from, const char* to) {
  if (counts(AT_FDCWD, to) && is_to_fail("rename", Needs::nothing, ++calls)) return -1;
  return real<int(const char*, const char*)>("rename")(from, to);
}

int mkdir(const char* path, mode_t mode) {
  if (counts(AT_FDCWD, path) && is_to_fail("mkdir", Needs::room, ++calls)) return -1;
  return real<int(const char*, mode_t)>("mkdir")(path, mode);
}

int unlink(const char* path) {
  if (counts(AT_FDCWD, path) && is_to_fail("unlink", Needs::nothing, ++calls)) return -1;
  return real<int(const char*)>("unlink")(path);
}
int unlinkat(int folder, const char* path, int flags) {
  if (counts(folder, path) && is_to_fail("unlink", Needs::nothing, ++calls)) return -1;
  return real<int(int, const char*, int)>("unlinkat")(folder, path, flags);
}
int remove(const char* path) {
  if (counts(AT_FDCWD, path) && is_to_fail("remove", Needs::nothing, ++calls)) return -1;
  return real<int(const char*)>("remove")(path);
}
int rmdir(const char* path) {
  if (counts(AT_FDCWD, path) && is_to_fail("rmdir", Needs::nothing, ++calls)) return -1;
  return real<int(const char*)>("rmdir")(path);
}

}  // extern "C"
