// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "calib/board_target.h"

namespace vernier::internal {

/// Reads Kalibr's target file: flat YAML, `key: value` a line, `#` begins a comment. Known are
///
///     target_type: 'aprilgrid'      tagCols, tagRows, tagSize (m), tagSpacing (over tagSize),
///                                   codeOffset: 0 (may be left out)
///     target_type: 'checkerboard'   targetCols, targetRows (inner corners),
///                                   rowSpacingMeters, colSpacingMeters
///
/// Throws Error with file and line, also for a circlegrid, which Vernier does not detect, and for
/// keys that are unknown, missing or said twice.
BoardTarget read_kalibr_target(const std::filesystem::path& file);

}  // namespace vernier::internal
