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

/// Edges on the faded image: matched ones from blue (smallest disparity) to red (largest), others
/// grey. Returns a PNG of twice the image size.
std::string disparity_picture(const GreyLevels& image,
                              const std::vector<EdgePoint>& edges,
                              const std::vector<EdgeDisparity>& found,
                              const DisparityRange& range);

/// Edges coloured by error: green up to 0.5 px, yellow up to 1 px, orange up to 3 px, red above;
/// blue if unmatched (infinite), black without ground truth (NaN).
std::string error_picture(const GreyLevels& image,
                          const std::vector<EdgePoint>& edges,
                          const std::vector<double>& errors_px);

}  // namespace vernier::cli
