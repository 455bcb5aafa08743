// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "stereo/grey_levels.h"
#include "stereo/matching/stretch_correlation.h"

namespace vernier::stereo::internal {

constexpr int max_filtered = 255;  // maximum magnitude of a filtered pixel

/// A filtered image for block comparison: one or more integer planes with replicated borders.
struct FilteredImage {
  int width = 0, height = 0, planes = 1;
  int margin_x = 0, margin_y = 0;
  std::vector<std::int16_t> values;

  std::size_t stride() const { return static_cast<std::size_t>(width + 2 * margin_x); }
  /// Pixel 0 of a row; −margin_x to width + margin_x − 1 are valid, rows likewise.
  const std::int16_t* row(int plane, int y) const { return values.data() + place(plane, y); }
  std::int16_t* row(int plane, int y) { return values.data() + place(plane, y); }

 private:
  std::size_t place(int plane, int y) const {
    const int row = plane * (height + 2 * margin_y) + y + margin_y;
    return static_cast<std::size_t>(row) * stride() + static_cast<std::size_t>(margin_x);
  }
};

FilteredImage filtered(const GreyLevels& image,
                       const StretchOptions& options,
                       int margin_x,
                       int margin_y);

}  // namespace vernier::stereo::internal
