// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <string>

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// Signals INT, TERM and HUP remove temporary files and end the program by the same signal, so that
/// the caller sees which; those that the caller ignores (nohup) stay ignored. A second signal ends
/// it at once. Also makes faults of SIGPIPE and SIGXFSZ. Call it before any thread is started.
/// `told_by_another`: says nothing of a signal, since another process does: mpirun ends all alike.
void watch_ending_signals(bool told_by_another);

/// Whether the caller of the program ignored the signal.
bool was_ignored(int signal) noexcept;

/// Removes temporary files and ends the program by the signal.
[[noreturn]] void end_by(int signal) noexcept;

/// While it exists, the first signal only asks to stop at the next point from which the work can go
/// on. At most one at a time.
class StopSignal {
 public:
  StopSignal();
  ~StopSignal();  ///< ends the program if a signal came and end() was not called
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  std::stop_token token() const { return source_.get_token(); }
  bool came() const { return source_.stop_requested(); }
  /// Says "vernier: ended by SIGINT " and the text (unless another process does), and ends by the
  /// signal that came.
  [[noreturn]] void end(const std::string& text) const;

 private:
  std::stop_source source_;
};

}  // namespace vernier::cli
