// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

#include "sim/study/work_units.h"

namespace vernier::sim::internal {

/// A unit that has been computed, or has failed.
struct FinishedUnit {
  std::int64_t number = 0;  ///< as it was given with the unit
  UnitResult result;
  std::exception_ptr failure;  ///< null: none
};

/// Threads that compute units beside the thread that hands them out: a rank's own part.
class WorkerThreads {
 public:
  /// Keeps a reference to the computer. `stop` is asked between the queries of a unit.
  WorkerThreads(const UnitComputer& computer, int threads, std::stop_token stop);
  /// Waits for the units that run; those not begun are dropped.
  ~WorkerThreads();
  WorkerThreads(const WorkerThreads&) = delete;
  WorkerThreads& operator=(const WorkerThreads&) = delete;

  void start(std::int64_t number, WorkUnit unit);
  /// Drops the units that no thread has begun.
  void drop_waiting();
  /// How many units were started and not yet taken back.
  int unfinished() const { return unfinished_; }
  int threads() const { return static_cast<int>(threads_.size()); }
  /// Those finished since the last call; waits up to `patience` for the first.
  std::vector<FinishedUnit> take_finished(std::chrono::microseconds patience);

 private:
  struct Given {
    std::int64_t number = 0;
    WorkUnit unit;
  };
  void work();

  const UnitComputer& computer_;
  std::stop_token stop_;
  std::mutex mutex_;
  std::condition_variable given_changed_, finished_changed_;
  std::deque<Given> given_;
  std::vector<FinishedUnit> finished_;
  bool ending_ = false;
  int unfinished_ = 0;  // of the handing thread only
  std::vector<std::thread> threads_;
};

}  // namespace vernier::sim::internal
