// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/range_probe.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/edge_matcher.h"
#include "stereo/grey_levels.h"
#include "stereo/image/half_size.h"

namespace vernier::stereo::internal {

OutsideRange outside_range(const RectifiedPair& pair, const DisparityRange& range) {
  constexpr int least_side_px = 64, least_longer_px = 16;
  constexpr float clearly_px = 1.5f;  // of half the size
  OutsideRange outside;
  outside.wider = range;
  if (std::min(pair.left.width_px, pair.left.height_px) < least_side_px) return outside;
  const RectifiedPair half{half_size(pair.left), half_size(pair.right)};
  const int lowest = static_cast<int>(std::floor(0.5 * range.min_px)),
            highest = static_cast<int>(std::ceil(0.5 * range.max_px));
  const int longer = std::max(least_longer_px, (highest - lowest) / 2),
            most = half.left.width_px - 1;
  const DisparityRange searched{std::max(lowest - longer, -most), std::min(highest + longer, most)};

  std::vector<float> found;
  for (const EdgeMatch& match : match_edges(half, canny_edges(half.left), searched)) {
    if (match.at.matched()) found.push_back(match.at.disparity_px);
  }
  if (found.empty()) return outside;
  std::sort(found.begin(), found.end());
  const float least = 0.5f * static_cast<float>(range.min_px) - clearly_px,
              largest = 0.5f * static_cast<float>(range.max_px) + clearly_px;
  const auto n = static_cast<double>(found.size());
  const auto below = std::lower_bound(found.begin(), found.end(), least),
             above = std::upper_bound(found.begin(), found.end(), largest);
  outside.matched = static_cast<int>(found.size());
  outside.below = static_cast<double>(below - found.begin()) / n;
  outside.above = static_cast<double>(found.end() - above) / n;
  constexpr float margin_px = 3;
  const std::size_t hundredth = found.size() / 100;
  outside.wider = {
      std::min(range.min_px, static_cast<int>(std::floor(2 * found[hundredth] - margin_px))),
      std::max(range.max_px,
               static_cast<int>(std::ceil(2 * found[found.size() - 1 - hundredth] + margin_px)))};
  return outside;
}

}  // namespace vernier::stereo::internal
