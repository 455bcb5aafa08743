// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>

namespace vernier::sim::internal {

/// Once ranks are asked to stop, what runs has so long: mpirun kills its processes a second after
/// it asks them to end.
class Grace {
 public:
  bool is_over(bool stop_requested) {
    const auto now = std::chrono::steady_clock::now();
    if (stop_requested && !end_) end_ = now + std::chrono::milliseconds(300);
    return end_ && now >= *end_;
  }

 private:
  std::optional<std::chrono::steady_clock::time_point> end_;
};

}  // namespace vernier::sim::internal
