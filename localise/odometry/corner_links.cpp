// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/odometry.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/triangulation.h"
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

/// Links each other's best among the pairs of indices that may be linked.
template <typename Filter>
std::vector<CornerLink> mutual_links(std::span<const StereoCorner> from,
                                     std::span<const StereoCorner> to,
                                     const CornerLinkOptions& options,
                                     const Filter& may_be_linked) {
  std::vector<BestPartner> forward(from.size()), backward(to.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    for (std::size_t j = 0; j < to.size(); ++j) {
      const Eigen::VectorXf &a = from[i].descriptor, &b = to[j].descriptor;
      if (a.size() != b.size() || a.size() == 0 || !may_be_linked(i, j)) continue;
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

}  // namespace

std::vector<CornerLink> link_corners(std::span<const StereoCorner> from,
                                     std::span<const StereoCorner> to,
                                     const CornerLinkOptions& options) {
  const double reach2 = options.max_motion_px * options.max_motion_px;
  return mutual_links(from, to, options, [&](std::size_t i, std::size_t j) {
    return (to[j].left_px - from[i].left_px).squaredNorm() <= reach2;
  });
}

std::vector<CornerLink> link_corners_near(const Rig& rig,
                                          std::span<const StereoCorner> from,
                                          std::span<const StereoCorner> to,
                                          const Pose& T_from_to,
                                          double window_px,
                                          const CornerLinkOptions& options) {
  const Pose T_to_from = T_from_to.inverse();
  std::vector<std::optional<PixelPair>> predicted(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    const auto x_m = triangulate_point(rig, {from[i].left_px, from[i].right_px});
    if (x_m) predicted[i] = pixel_pair(rig, T_to_from * *x_m);
  }
  const double reach2 = window_px * window_px;
  return mutual_links(from, to, options, [&](std::size_t i, std::size_t j) {
    return predicted[i] && (to[j].left_px - predicted[i]->first_px).squaredNorm() <= reach2 &&
           (to[j].right_px - predicted[i]->other_px).squaredNorm() <= reach2;
  });
}

}  // namespace vernier::localise
