// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {

/// What every matcher refuses: images of unequal size or without pixels, and a range that is empty
/// or reaches beyond the images' width. Throws Error(place).
void check_matcher_input(const RectifiedPair& pair,
                         const DisparityRange& range,
                         const std::string& place);

}  // namespace vernier::stereo::internal
