// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// Edges over the faded image: matched ones from blue (the least disparity) to red (the largest),
/// others grey. The bytes of a PNG, of twice the image's size.
std::string disparity_picture(const GreyLevels& image,
                              const std::vector<EdgePoint>& edges,
                              const std::vector<EdgeDisparity>& found,
                              const DisparityRange& range);

/// Edges by their error: green to half a pixel, yellow to 1 px, orange to 3 px, red beyond; blue
/// where nothing was found (infinite), black where nothing is known (not a number).
std::string error_picture(const GreyLevels& image,
                          const std::vector<EdgePoint>& edges,
                          const std::vector<double>& errors_px);

}  // namespace vernier::cli
