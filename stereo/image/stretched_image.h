// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {

/// The image `scale` times as wide: pixel P shows what is at P / scale, linearly between pixels,
/// averaged over a new pixel's width where it becomes narrower.
GreyLevels stretched(const GreyLevels& image, double scale);

/// With every row turned round.
GreyLevels mirrored(const GreyLevels& image);

}  // namespace vernier::stereo::internal
