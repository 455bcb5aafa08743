// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/corners/match_support.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "stereo/corners/corner_match.h"

namespace vernier::stereo::internal {
namespace {

constexpr double always_allowed_px = 1;

int agreeing(const std::vector<CornerMatch>& matches,
             std::size_t own,
             const CornerMatchingOptions& options) {
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (i != own) near.emplace_back((matches[i].left_px - matches[own].left_px).norm(), i);
  }
  std::partial_sort(near.begin(), near.begin() + options.neighbours, near.end());
  const CornerMatch& match = matches[own];
  return static_cast<int>(
      std::count_if(near.begin(), near.begin() + options.neighbours, [&](const auto& neighbour) {
        const CornerMatch& other = matches[neighbour.second];
        const Eigen::Vector2d carried = match.right_by_left * (other.left_px - match.left_px);
        const double apart = (other.right_px - match.right_px - carried).norm();
        return apart <= std::max(always_allowed_px, options.support_slope * carried.norm());
      }));
}

}  // namespace

std::vector<CornerMatch> supported(const std::vector<CornerMatch>& matches,
                                   const CornerMatchingOptions& options) {
  if (matches.size() <= static_cast<std::size_t>(options.neighbours)) return matches;
  std::vector<CornerMatch> kept;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (agreeing(matches, i, options) >= options.support) kept.push_back(matches[i]);
  }
  return kept;
}

}  // namespace vernier::stereo::internal
