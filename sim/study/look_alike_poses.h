// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "localise/place.h"
#include "sim/study/wire_frame.h"

namespace vernier::sim::internal {

/// Poses from which a world may look as a view does: those at which two edges of the view lie on
/// edges of the world's wire frame.
///
/// Two uprights p, q of the view at least 0.3 m apart are fitted to every two uprights a, b of the
/// world of which they may be visible parts and whose distance is the same, to 1 cm:
///
///     turn = angle(b - a) - angle(q - p),   shift = a - R(turn) p
///
/// An upright and a level edge of the view are fitted likewise to every upright with a level edge
/// at that height and that distance from it; in a view without an upright, two level edges that are
/// not parallel to every two level edges at their heights and that angle. A view may differ
/// somewhere from a place that looks like it, so several disjoint pairs are taken, until their
/// shorter edges have `needed_share` of the image length of all edges together: a pose that none of
/// them gives leaves more than that unexplained. The quickest are taken first, and at most six;
/// fewer where no edge is rare among very many.
class LookAlikePoses {
 public:
  /// Keeps a reference to `frame`.
  explicit LookAlikePoses(const WireFrame& frame) : frame_(frame) {}

  /// Calls `visit` for every pose, some of them more than once, until it returns true. False if
  /// the view has no such pair (it then fits poses in a continuum, or any at all), or if there are
  /// too many level edges to try for each pair.
  bool visit(const std::vector<ViewEdge>& view,
             double needed_share,
             const std::function<bool(const localise::Pose2D&)>& visit) const;

 private:
  struct Pair {
    int first, second;  ///< of the view's edges; the first is upright, or neither
  };
  std::vector<Pair> pairs(const std::vector<ViewEdge>& view, double needed_share) const;
  void pair_uprights(const std::vector<ViewEdge>& view,
                     double needed_px,
                     std::vector<Pair>& pairs,
                     std::vector<char>& used) const;
  void pair_levels(const std::vector<ViewEdge>& view,
                   double needed_px,
                   std::vector<Pair>& pairs) const;
  struct Tried {
    bool enough = false, all = true;  ///< that `fits` wants; that there are
  };
  Tried fit_levels(const ViewEdge& p,
                   const ViewEdge& q,
                   const std::function<bool(const localise::Pose2D&)>& fits) const;

  const WireFrame& frame_;
};

}  // namespace vernier::sim::internal
