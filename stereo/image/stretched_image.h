// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {

/// The image resized to `scale` times its width: pixel P samples P / scale, with linear
/// interpolation, averaged over a new pixel's width when shrinking.
GreyLevels stretched(const GreyLevels& image, double scale);

/// The image mirrored along its rows.
GreyLevels mirrored(const GreyLevels& image);

}  // namespace vernier::stereo::internal
