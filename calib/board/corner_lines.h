// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "calib/board_observations.h"

/// Internal to calib/: what the readers of files with a corner a line share. Not installed.
namespace vernier::internal::corner_lines {

/// Throws Error for a pixel that is not finite or, where their size is known, outside its camera's
/// images; one size stands for all. `corner` names it in a person's words.
void check_pixel(const Eigen::Vector2d& pixel_px,
                 std::size_t camera,
                 const std::vector<Eigen::Vector2i>& size_px,
                 const std::string& place,
                 const std::string& corner);

/// Gives all cameras their size where one stands for them, then check_and_sort; what that says
/// begins with the file.
BoardObservations finished(BoardObservations observations,
                           std::size_t cameras,
                           const std::filesystem::path& file);

}  // namespace vernier::internal::corner_lines
