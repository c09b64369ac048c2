// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "interrupt.hpp"

namespace posemix {
namespace {

volatile std::sig_atomic_t noted_signal = 0;

extern "C" void note_signal(int signal) { noted_signal = signal; }

}  // namespace

InterruptGuard::InterruptGuard() {
  noted_signal = 0;
  struct sigaction action {};
  action.sa_handler = note_signal;
  action.sa_flags = SA_RESETHAND;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, &before_int_);
  sigaction(SIGTERM, &action, &before_term_);
}

InterruptGuard::~InterruptGuard() {
  sigaction(SIGINT, &before_int_, nullptr);
  sigaction(SIGTERM, &before_term_, nullptr);
}

bool InterruptGuard::interrupted() const { return noted_signal != 0; }

int InterruptGuard::signal() const { return noted_signal; }

int recorded_signal() { return noted_signal; }

void InterruptGuard::check() const {
  if (interrupted()) throw Interrupted(noted_signal);
}

}  // namespace posemix
