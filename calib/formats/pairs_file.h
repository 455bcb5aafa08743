// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "calib/pair_observations.h"

namespace vernier::internal {

/// Reads `pair,u_left_px,v_left_px,u_right_px,v_right_px,sigma_px`: one match a line under that
/// header, those of one image pair together. Throws Error with file and line for anything that is
/// no such line, is not finite, or has no noise above 0; see check_pairs() for what a rig says of
/// them.
PairObservations read_pairs(const std::filesystem::path& file);

/// Writes the same; numbers are exact (shortest form that reads back equal).
void write_pairs(const PairObservations& pairs, const std::filesystem::path& file);

}  // namespace vernier::internal
