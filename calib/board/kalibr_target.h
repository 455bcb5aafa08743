// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "calib/board_target.h"

namespace vernier::internal {

/// Reads Kalibr's target file: flat YAML, one `key: value` per line, `#` begins a comment.
/// Supported:
///
///     target_type: 'aprilgrid'      tagCols, tagRows, tagSize (m), tagSpacing (over tagSize),
///                                   codeOffset: 0 (optional)
///     target_type: 'checkerboard'   targetCols, targetRows (inner corners),
///                                   rowSpacingMeters, colSpacingMeters
///
/// Throws Error with file and line, also for a circlegrid, which is not supported, and for keys
/// that are unknown, missing or repeated.
BoardTarget read_kalibr_target(const std::filesystem::path& file);

}  // namespace vernier::internal
