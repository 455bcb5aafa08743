// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {

/// Checks common to all matchers: throws Error(place) for images of different sizes or without
/// pixels, and for a range that is empty or exceeds the image width.
void check_matcher_input(const RectifiedPair& pair,
                         const DisparityRange& range,
                         const std::string& place);

/// Throws Error (`place`) for a range that is empty or exceeds the width of the images.
void check_range(const DisparityRange& range, int width_px, const std::string& place);

}  // namespace vernier::stereo::internal
