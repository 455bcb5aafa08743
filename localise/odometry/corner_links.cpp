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
#include "localise/odometry/mutual_links.h"
#include "localise/place.h"

namespace vernier::localise {

using namespace internal;

namespace {

/// Of the pairs of corners that may be linked.
template <typename Filter>
std::vector<CornerLink> described_links(std::span<const StereoCorner> from,
                                        std::span<const StereoCorner> to,
                                        const CornerLinkOptions& options,
                                        const Filter& may_be_linked) {
  return mutual_links(from.size(), to.size(), options, [&](std::size_t i, std::size_t j) {
    const Eigen::VectorXf &a = from[i].descriptor, &b = to[j].descriptor;
    const bool linkable = a.size() == b.size() && a.size() > 0 && may_be_linked(i, j);
    return linkable ? a.dot(b) : no_similarity;
  });
}

}  // namespace

std::vector<CornerLink> link_corners(std::span<const StereoCorner> from,
                                     std::span<const StereoCorner> to,
                                     const CornerLinkOptions& options) {
  const double reach2 = options.max_motion_px * options.max_motion_px;
  return described_links(from, to, options, [&](std::size_t i, std::size_t j) {
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
  return described_links(from, to, options, [&](std::size_t i, std::size_t j) {
    return predicted[i] && (to[j].left_px - predicted[i]->first_px).squaredNorm() <= reach2 &&
           (to[j].right_px - predicted[i]->other_px).squaredNorm() <= reach2;
  });
}

}  // namespace vernier::localise
