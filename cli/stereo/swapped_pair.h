// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "stereo/grey_levels.h"
#include "stereo/matcher.h"

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// Fraction of edges that have a disparity; 0 if there are no edges.
double matched_share(const std::vector<EdgeDisparity>& found);

/// Throws Error(`place`) if less than half of the edges are matched and the matcher finds at least
/// twice as many, and at least 30 %, in the pair with left and right swapped.
void check_not_swapped(const Matcher& matcher,
                       const std::vector<EdgeDisparity>& found,
                       const DisparityRange& range,
                       const std::function<RectifiedPair()>& exchanged,
                       const std::string& place);

}  // namespace vernier::cli
