// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "localise/join/line_fit.h"

namespace vernier::localise::internal {

/// How far a line's sightings reach along it (join_lines(), "Ends"): stations, and whose ends they
/// are: position in `sightings` and 0 for a, 1 for b.
struct LineReach {
  double low_m = 0, high_m = 0;
  std::size_t low_sighting = 0, high_sighting = 0;
  int low_end = 0, high_end = 0;
};
LineReach reach(std::span<const WorldSighting* const> sightings, const LineFrame& frame);

}  // namespace vernier::localise::internal
