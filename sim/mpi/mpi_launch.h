// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

namespace vernier::sim::internal {

/// How mpirun, or Slurm's srun with --mpi=pmix, started this process.
struct MpiLaunch {
  int rank = 0;
  int size = 1;
};

/// From the environment: OMPI_COMM_WORLD_RANK and _SIZE of Open MPI's mpirun; PMIX_RANK with
/// SLURM_NTASKS of srun. Nothing if the process was started otherwise, or alone.
std::optional<MpiLaunch> mpi_launch();

}  // namespace vernier::sim::internal
