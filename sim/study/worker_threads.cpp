// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/worker_threads.h"

#include <chrono>
#include <cstdint>
#include <exception>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

#include "sim/study/work_units.h"

namespace vernier::sim::internal {

WorkerThreads::WorkerThreads(const UnitComputer& computer, int threads, std::stop_token stop)
    : computer_(computer), stop_(std::move(stop)) {
  for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { work(); });
}

WorkerThreads::~WorkerThreads() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    given_.clear();
  }
  given_changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void WorkerThreads::start(std::int64_t number, WorkUnit unit) {
  {
    const std::lock_guard lock(mutex_);
    given_.push_back({number, std::move(unit)});
  }
  ++unfinished_;
  given_changed_.notify_one();
}

void WorkerThreads::drop_waiting() {
  const std::lock_guard lock(mutex_);
  unfinished_ -= static_cast<int>(given_.size());
  given_.clear();
}

std::vector<FinishedUnit> WorkerThreads::take_finished(std::chrono::microseconds patience) {
  std::vector<FinishedUnit> taken;
  std::unique_lock lock(mutex_);
  finished_changed_.wait_for(lock, patience, [&] { return !finished_.empty(); });
  taken.swap(finished_);
  unfinished_ -= static_cast<int>(taken.size());
  return taken;
}

void WorkerThreads::work() {
  for (;;) {
    Given given;
    {
      std::unique_lock lock(mutex_);
      given_changed_.wait(lock, [&] { return ending_ || !given_.empty(); });
      if (given_.empty()) return;
      given = std::move(given_.front());
      given_.pop_front();
    }
    FinishedUnit done{given.number, {}, nullptr};
    try {
      done.result = computer_.compute(given.unit, stop_);
    } catch (...) {
      done.failure = std::current_exception();
    }
    {
      const std::lock_guard lock(mutex_);
      finished_.push_back(std::move(done));
    }
    finished_changed_.notify_one();
  }
}

}  // namespace vernier::sim::internal
