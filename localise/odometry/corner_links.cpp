// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <span>
#include <vector>

#include "localise/odometry.h"

#include "localise/place.h"

namespace vernier::localise {

namespace {

/// The most similar corner of the other moment, and the lead over the second.
struct BestPartner {
  int index = -1;
  float similarity = -2, second = -2;

  void offer(int candidate, float value) {
    if (value > similarity) {
      second = similarity;
      similarity = value;
      index = candidate;
    } else if (value > second) {
      second = value;
    }
  }
};

}  // namespace

std::vector<CornerLink> link_corners(std::span<const StereoCorner> from,
                                     std::span<const StereoCorner> to,
                                     const CornerLinkOptions& options) {
  const double reach2 = options.max_motion_px * options.max_motion_px;
  std::vector<BestPartner> forward(from.size()), backward(to.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    for (std::size_t j = 0; j < to.size(); ++j) {
      const Eigen::VectorXf &a = from[i].descriptor, &b = to[j].descriptor;
      if (a.size() != b.size() || a.size() == 0) continue;
      if ((to[j].left_px - from[i].left_px).squaredNorm() > reach2) continue;
      const float similarity = a.dot(b);
      forward[i].offer(static_cast<int>(j), similarity);
      backward[j].offer(static_cast<int>(i), similarity);
    }
  }
  const auto is_clear = [&](const BestPartner& best) {
    return best.index >= 0 && best.similarity >= options.min_similarity &&
           best.similarity - best.second >= options.min_margin;
  };
  std::vector<CornerLink> links;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const BestPartner& best = forward[i];
    if (!is_clear(best)) continue;
    const BestPartner& back = backward[static_cast<std::size_t>(best.index)];
    if (back.index == static_cast<int>(i) && is_clear(back)) {
      links.push_back({static_cast<int>(i), best.index});
    }
  }
  return links;
}

}  // namespace vernier::localise
