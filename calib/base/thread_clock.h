// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <time.h>

namespace vernier::internal {

/// CPU time of this thread, and time, milliseconds, since it was made. For one thread.
class ThreadClock {
 public:
  double cpu_ms() const { return now_ms(CLOCK_THREAD_CPUTIME_ID) - cpu_ms_; }
  double wall_ms() const { return now_ms(CLOCK_MONOTONIC) - wall_ms_; }

 private:
  static double now_ms(clockid_t clock) {
    timespec now{};
    ::clock_gettime(clock, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
  }

  double cpu_ms_ = now_ms(CLOCK_THREAD_CPUTIME_ID), wall_ms_ = now_ms(CLOCK_MONOTONIC);
};

}  // namespace vernier::internal
