// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/corners/corner_match.h"

namespace vernier::stereo::internal {

/// Matches consistent with at least `support` of their nearest neighbours: the offset
/// between two right pixels differs from that of the left ones, carried over by the prior's
/// derivative, by at most a pixel or `support_slope` times that offset, a limit on the disparity
/// gradient (Pollard, Mayhew and Frisby 1985). Returns all matches if there are no
/// more than `neighbours`.
std::vector<CornerMatch> supported(const std::vector<CornerMatch>& matches,
                                   const CornerMatchingOptions& options);

}  // namespace vernier::stereo::internal
