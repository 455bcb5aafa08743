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
#include "stereo/matcher.h"

namespace vernier::stereo::internal {

namespace {

/// Whether what this pixel of half the size comes from has a source.
bool is_valid(const HasSource& has_source, const GreyLevels& image, float x, int y) {
  if (!has_source) return true;
  const int at = static_cast<int>(std::lround(2 * x));
  return at >= 0 && at < image.width_px && has_source(at, 2 * y);
}

}  // namespace

OutsideRange outside_range(const RectifiedPair& pair,
                           const DisparityRange& range,
                           const HasSource& left_has_source,
                           const HasSource& right_has_source) {
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

  std::vector<EdgePoint> edges = canny_edges(half.left);
  std::erase_if(edges, [&](const EdgePoint& e) {
    return !is_valid(left_has_source, pair.left, static_cast<float>(e.x), e.y);
  });
  outside.edges = static_cast<int>(edges.size());
  std::vector<float> found;
  const std::vector<EdgeMatch> matches = match_edges(half, edges, searched);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const EdgeDisparity& at = matches[i].at;
    if (!at.matched()) continue;
    const float right_x = static_cast<float>(edges[i].x) - at.disparity_px;
    if (is_valid(right_has_source, pair.right, right_x, edges[i].y))
      found.push_back(at.disparity_px);
  }
  if (found.empty()) return outside;
  std::sort(found.begin(), found.end());
  const float least = 0.5f * static_cast<float>(range.min_px) - clearly_px,
              largest = 0.5f * static_cast<float>(range.max_px) + clearly_px;
  outside.matched = static_cast<int>(found.size());
  outside.below =
      static_cast<int>(std::lower_bound(found.begin(), found.end(), least) - found.begin());
  outside.above =
      static_cast<int>(found.end() - std::upper_bound(found.begin(), found.end(), largest));
  constexpr float margin_px = 3;
  const std::size_t hundredth = (found.size() - 1) / 100;
  const int low_px = static_cast<int>(std::floor(2 * found[hundredth] - margin_px)),
            high_px =
                static_cast<int>(std::ceil(2 * found[found.size() - 1 - hundredth] + margin_px));
  const int width_px = pair.left.width_px;
  outside.wider = {std::min(range.min_px, std::max(low_px, 1 - width_px)),
                   std::max(range.max_px, std::min(high_px, width_px - 1))};
  return outside;
}

}  // namespace vernier::stereo::internal
