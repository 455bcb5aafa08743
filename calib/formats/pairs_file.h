// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "calib/pair_observations.h"

namespace vernier::internal {

/// Reads `pair,u_left_px,v_left_px,u_right_px,v_right_px,sigma_px`: one match per line below that
/// header, matches of one image pair together. Throws Error with file and line for a malformed
/// line, a value that is not finite, or noise that is not above 0; check_pairs() checks them
/// against a rig.
PairObservations read_pairs(const std::filesystem::path& file);

/// Writes the same; numbers are exact (shortest form that reads back equal).
std::string format_pairs(const PairObservations& pairs);
void write_pairs(const PairObservations& pairs, const std::filesystem::path& file);

}  // namespace vernier::internal
