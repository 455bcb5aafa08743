// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "sim/study/communicator.h"

namespace vernier::sim::internal {

/// The processes that MPI started together, as long as this exists; the destructor waits for all of
/// them. Only the thread that makes it may use it (MPI_THREAD_FUNNELED), once in a process.
class MpiRanks : public Communicator {
 public:
  /// This rank's part of the cores that it may run on, at least 1: they are divided among the ranks
  /// of this machine that may run on the same ones (mpirun --bind-to none).
  virtual int cores() const = 0;
};

/// Starts MPI. Throws Error that says what to install where Vernier was built without MPI, and if
/// MPI cannot be started.
std::unique_ptr<MpiRanks> mpi_ranks();

/// MPI's name and version; empty where Vernier was built without it.
std::string mpi_version();

}  // namespace vernier::sim::internal
