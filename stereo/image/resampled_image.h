// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {

/// Where an image has what a pixel of its resampled one shows; nothing: not known.
using PixelSource = std::function<std::optional<Eigen::Vector2d>(int x, int y)>;

/// An image read at other places, by cubic convolution (Keys 1981, a = −1/2) in full precision.
/// Places beyond the border take the border's value, those not known 0. Bits do not depend on the
/// number of threads.
GreyLevels resampled(const GreyLevels& image,
                     const Eigen::Vector2i& size_px,
                     const PixelSource& source,
                     int threads);

}  // namespace vernier::stereo::internal
