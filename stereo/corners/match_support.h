// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/corners/corner_match.h"

namespace vernier::stereo::internal {

/// The matches that enough of their nearest neighbours agree with: displacements right − left
/// differ by at most a pixel or `support_slope` of the distance in the left image, which is a limit
/// on the disparity gradient (Pollard, Mayhew and Frisby 1985). All of them where there are no more
/// than `neighbours`.
std::vector<CornerMatch> supported(const std::vector<CornerMatch>& matches,
                                   const CornerMatchingOptions& options);

}  // namespace vernier::stereo::internal
