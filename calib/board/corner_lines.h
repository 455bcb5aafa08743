// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "calib/board_observations.h"

/// Internal to calib/: common code of the readers of files with one corner per line. Not installed.
namespace vernier::internal::corner_lines {

/// Throws Error for a pixel that is not finite or, if the sizes are known, outside the image of its
/// camera; a single size applies to all cameras. `corner` describes it in messages.
void check_pixel(const Eigen::Vector2d& pixel_px,
                 std::size_t camera,
                 const std::vector<Eigen::Vector2i>& size_px,
                 const std::string& place,
                 const std::string& corner);

/// Gives all cameras the size if only one is given, then calls check_and_sort; its errors are
/// prefixed with the file.
BoardObservations finished(BoardObservations observations,
                           std::size_t cameras,
                           const std::filesystem::path& file);

}  // namespace vernier::internal::corner_lines
