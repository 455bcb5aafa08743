// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/visibility/stretch_feature.h"

#include <string>

#include "calib/error.h"

namespace vernier::sim::internal {

std::uint32_t stretch_feature(int segment, int run, std::size_t segments) {
  const std::uint64_t page = static_cast<std::uint64_t>(run) / 32;
  const std::uint64_t feature =
      32 * (page * segments + static_cast<std::uint64_t>(segment)) + run % 32;
  if (feature >> 31 != 0) {  // another bit identifies the piece of the run
    throw Error("segment " + std::to_string(segment),
                "the identity of visible run " + std::to_string(run) + " exceeds 31 bits",
                "use a smaller world, or fewer occluders in front of this edge");
  }
  return static_cast<std::uint32_t>(feature);
}

}  // namespace vernier::sim::internal
