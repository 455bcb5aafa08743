// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {

/// An image padded by replicating its border, so that access needs no bounds checks.
class PaddedImage {
 public:
  PaddedImage(const GreyLevels& image, int margin_px)
      : width_(image.width_px),
        height_(image.height_px),
        margin_(margin_px),
        stride_(static_cast<std::size_t>(image.width_px + 2 * margin_px)),
        values_(stride_ * static_cast<std::size_t>(image.height_px + 2 * margin_px)) {
    for (int y = -margin_px; y < image.height_px + margin_px; ++y) {
      const int from = std::clamp(y, 0, image.height_px - 1);
      float* const to = values_.data() + static_cast<std::size_t>(y + margin_px) * stride_;
      const float* const own =
          image.values.data() + static_cast<std::size_t>(from) * static_cast<std::size_t>(width_);
      std::copy_n(own, width_, to + margin_px);
      std::fill_n(to, margin_px, own[0]);
      std::fill_n(to + margin_px + width_, margin_px, own[width_ - 1]);
    }
  }

  int width() const { return width_; }
  int height() const { return height_; }
  /// Pixel 0 of a row; pixels −margin to width + margin − 1 are valid.
  const float* row(int y) const {
    return values_.data() + static_cast<std::size_t>(y + margin_) * stride_ +
           static_cast<std::size_t>(margin_);
  }

 private:
  int width_, height_, margin_;
  std::size_t stride_;
  std::vector<float> values_;
};

}  // namespace vernier::stereo::internal
