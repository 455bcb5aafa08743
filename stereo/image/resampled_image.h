// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {

/// Source position of a pixel of the resampled image; nullopt: none.
using PixelSource = std::function<std::optional<Eigen::Vector2d>(int x, int y)>;

/// Resamples an image by cubic convolution (Keys 1981, a = −1/2) without rounding to grey levels.
/// The border is replicated; pixels without a source are 0. Results do not depend on the number of
/// threads.
GreyLevels resampled(const GreyLevels& image,
                     const Eigen::Vector2i& size_px,
                     const PixelSource& source,
                     int threads);

}  // namespace vernier::stereo::internal
