// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/planning/frame_kinds.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "calib/board_observations.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"

namespace vernier::internal {

std::vector<FrameKind> frame_kinds(const BoardObservations& observations,
                                   const std::vector<int>& frames) {
  std::map<int, std::set<int>> cameras_of;
  for (const BoardView& view : observations.views) cameras_of[view.frame].insert(view.camera);
  std::map<std::vector<int>, FrameKind> kinds;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto seen = cameras_of.find(frames[i]);
    if (seen == cameras_of.end()) continue;
    const std::vector<int> cameras(seen->second.begin(), seen->second.end());
    FrameKind& kind = kinds[cameras];
    kind.cameras = cameras;
    kind.frames.push_back(i);
  }
  std::vector<FrameKind> result;
  for (auto& [cameras, kind] : kinds) result.push_back(std::move(kind));
  std::stable_sort(result.begin(), result.end(), [](const FrameKind& a, const FrameKind& b) {
    return a.cameras.size() > b.cameras.size();
  });
  return result;
}

std::vector<double> drawn_shares(const std::vector<FrameKind>& kinds,
                                 std::uint64_t seed,
                                 std::uint32_t number) {
  std::vector<double> shares;
  double sum = 0;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    RandomStream draws({.seed = seed,
                        .trial = number,
                        .feature = static_cast<std::uint32_t>(k),
                        .source = static_cast<std::uint32_t>(DrawSource::planned_views),
                        .eye = 3});
    // a gamma variable of n frames is half a chi-squared one of 2 n degrees of freedom
    shares.push_back(draw_chi_squared(draws, 2.0 * static_cast<double>(kinds[k].frames.size())));
    sum += shares.back();
  }
  for (double& share : shares) share /= sum;
  return shares;
}

}  // namespace vernier::internal
