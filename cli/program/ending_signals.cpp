// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/program/ending_signals.h"

#include <pthread.h>
#include <unistd.h>

#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <mutex>
#include <string>

#include "calib/base/unfinished_work.h"
#include "cli/program/streams.h"

namespace vernier::cli {
namespace {

struct EndingState {
  std::mutex mutex;
  std::stop_source* stop = nullptr;  ///< of the StopSignal that exists
  int signal = 0;                    ///< that asked it to stop
  sigset_t ignored_by_caller{};
  sigset_t watched{};
  bool told_by_another = false;  ///< as in watch_ending_signals()
};

EndingState& ending() {
  static EndingState* const only = new EndingState;  // never destroyed: a thread reads it
  return *only;
}

const char* short_name(int signal) {
  switch (signal) {
    case SIGINT:
      return "SIGINT";
    case SIGTERM:
      return "SIGTERM";
    case SIGHUP:
      return "SIGHUP";
    default:
      return "a signal";
  }
}

/// Says what becomes of the signal, unless another process does.
void tell(const std::string& text) {
  if (!ending().told_by_another) say(text);
}

/// Lets the signal end the program at once.
void restore_default(int signal) noexcept {
  std::signal(signal, SIG_DFL);
  sigset_t one;
  sigemptyset(&one);
  sigaddset(&one, signal);
  pthread_sigmask(SIG_UNBLOCK, &one, nullptr);
}

/// Whether the signal is the first one to work that can stop by itself.
bool asks_to_stop(int signal) {
  const std::lock_guard lock(ending().mutex);
  if (!ending().stop || ending().signal) return false;
  ending().signal = signal;
  ending().stop->request_stop();
  if (::isatty(STDERR_FILENO)) {
    tell("\nvernier: stopping after the running blocks; a second signal ends at once\n");
  }
  return true;
}

void* wait_for_signals(void*) {
  int signal = 0;
  do {
    if (sigwait(&ending().watched, &signal) != 0) return nullptr;
  } while (asks_to_stop(signal));
  for (const int next : {SIGINT, SIGTERM, SIGHUP}) {
    if (sigismember(&ending().watched, next)) restore_default(next);
  }
  tell(std::string(::isatty(STDERR_FILENO) ? "\n" : "") + "vernier: ended by " +
       short_name(signal) + "; unfinished files are removed\n");
  end_by(signal);
}

void start_watching() {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  constexpr std::size_t stack_bytes = 256 * 1024;
  pthread_attr_setstacksize(&attributes, stack_bytes);
  pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
  pthread_t thread;
  if (pthread_create(&thread, &attributes, wait_for_signals, nullptr) != 0) {
    pthread_sigmask(SIG_UNBLOCK, &ending().watched, nullptr);  // they end the program as usual
  }
  pthread_attr_destroy(&attributes);
}

}  // namespace

void watch_ending_signals(bool told_by_another) {
  EndingState& state = ending();
  state.told_by_another = told_by_another;
  sigemptyset(&state.ignored_by_caller);
  sigemptyset(&state.watched);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
    struct sigaction now {};
    const bool ignored = ::sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
    if (ignored) sigaddset(&state.ignored_by_caller, signal);
    if (!ignored && signal != SIGPIPE) sigaddset(&state.watched, signal);
  }
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGCHLD, SIG_DFL);  // else no program's exit code is known
  pthread_sigmask(SIG_BLOCK, &state.watched, nullptr);
  start_watching();
}

bool was_ignored(int signal) noexcept {
  return sigismember(&ending().ignored_by_caller, signal) == 1;
}

void end_by(int signal) noexcept {
  abandon_unfinished_work();
  restore_default(signal);
  ::raise(signal);
  ::_exit(128 + signal);  // not reached
}

StopSignal::StopSignal() {
  const std::lock_guard lock(ending().mutex);
  ending().stop = &source_;
}

StopSignal::~StopSignal() {
  int signal = 0;
  {
    const std::lock_guard lock(ending().mutex);
    ending().stop = nullptr;
    signal = ending().signal;
  }
  if (!signal) return;
  tell(std::string("vernier: ended by ") + short_name(signal) + "\n");
  end_by(signal);
}

void StopSignal::end(const std::string& text) const {
  int signal = 0;
  {
    const std::lock_guard lock(ending().mutex);
    signal = ending().signal;
  }
  tell(std::string("vernier: ended by ") + short_name(signal) + " " + text + "\n");
  end_by(signal);
}

}  // namespace vernier::cli
