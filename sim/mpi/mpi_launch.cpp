// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/mpi/mpi_launch.h"

#include <charconv>
#include <cstdlib>
#include <cstring>
#include <optional>

namespace vernier::sim::internal {

namespace {

/// A variable that is a whole number from 0 on.
std::optional<int> number_in(const char* variable) {
  const char* text = std::getenv(variable);
  if (!text) return std::nullopt;
  int value = 0;
  const char* end = text + std::strlen(text);
  const auto [last, fault] = std::from_chars(text, end, value);
  if (fault != std::errc() || last != end || value < 0) return std::nullopt;
  return value;
}

}  // namespace

std::optional<MpiLaunch> mpi_launch() {
  std::optional<int> rank = number_in("OMPI_COMM_WORLD_RANK"),
                     size = number_in("OMPI_COMM_WORLD_SIZE");
  if (!rank || !size) {
    rank = number_in("PMIX_RANK");
    size = number_in("SLURM_NTASKS");
  }
  if (!rank || !size || *size < 2 || *rank >= *size) return std::nullopt;
  return MpiLaunch{*rank, *size};
}

}  // namespace vernier::sim::internal
