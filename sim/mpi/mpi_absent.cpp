// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>

#include "calib/error.h"
#include "sim/mpi/mpi_ranks.h"

namespace vernier::sim::internal {

std::unique_ptr<MpiRanks> mpi_ranks() {
  throw Error("mpirun", "starts several processes, but MPI was missing when Vernier was built",
              "install Debian's libopenmpi-dev and rebuild, or use --shard");
}

std::string mpi_version() { return ""; }

}  // namespace vernier::sim::internal
