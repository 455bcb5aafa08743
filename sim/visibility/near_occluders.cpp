// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/visibility/near_occluders.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "sim/visibility/box_tree.h"
#include "sim/visibility/convex_pieces.h"
#include "sim/visibility/view_frustum.h"

namespace vernier::sim::internal {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

constexpr double large_m2 = 0.4;  ///< smaller surfaces hide too little
constexpr double least_apparent_sr = 0.1;
constexpr std::size_t most_occluders = 16;
constexpr int most_tried = 96;       ///< large surfaces that are looked at for one view
constexpr double to_spare_m = 1e-6;  ///< larger than any tolerance of a shadow
constexpr double least_distance_m = 1e-3;

double area_of(const ConvexSurfaces& surfaces, const ConvexSurface& piece) {
  const Vector3d* p = surfaces.vertices_m.data() + piece.first_vertex;
  Vector3d twice = Vector3d::Zero();
  for (int i = 1; i + 1 < piece.vertex_count; ++i) twice += (p[i] - p[0]).cross(p[i + 1] - p[0]);
  return twice.norm() / 2;
}

}  // namespace

LargeSurfaces::LargeSurfaces(const ConvexSurfaces& surfaces) {
  std::vector<AlignedBox3d> boxes;
  for (std::size_t i = 0; i < surfaces.pieces.size(); ++i) {
    const double area = area_of(surfaces, surfaces.pieces[i]);
    if (area < large_m2) continue;
    pieces_.push_back(static_cast<int>(i));
    areas_m2_.push_back(area);
    boxes.push_back(box_of(surfaces, surfaces.pieces[i]));
  }
  tree_ = BoxTree(std::move(boxes));
}

void NearOccluders::choose(const ConvexSurfaces& surfaces,
                           const LargeSurfaces& large,
                           const Vector3d& eye,
                           const ViewVolume& volume,
                           double gap_m) {
  sides_.clear();
  side_counts_.clear();
  int tried = 0;
  large.tree().visit_nearest(
      eye, [&](const AlignedBox3d& box) { return volume.may_meet(box) && !hide(box); },
      [&](int i) {
        const ConvexSurface& piece = surfaces.pieces[large.piece(i)];
        // A small surface at the middle of this one would look this large, times its share.
        const double distance = std::abs(piece.distance_m - piece.normal.dot(eye));
        const double range = std::max((piece.centre_m - eye).norm(), 0.3);
        const double apparent = large.area_m2(i) * distance / (range * range * range);
        if (distance > least_distance_m && apparent > least_apparent_sr) {
          add(surfaces, large.piece(i), eye, gap_m);
        }
        return ++tried >= most_tried || side_counts_.size() >= most_occluders;
      });
}

void NearOccluders::add(const ConvexSurfaces& surfaces,
                        int index,
                        const Vector3d& eye,
                        double gap_m) {
  const ConvexSurface& piece = surfaces.pieces[index];
  const Vector3d* p = surfaces.vertices_m.data() + piece.first_vertex;
  const double d = piece.distance_m - piece.normal.dot(eye);
  const double sign = d < 0 ? -1 : 1;  // so that the normal points away from the eye
  const auto side = [&](const Vector3d& inward, double beyond) {
    sides_.push_back({inward, inward.cwiseAbs(), inward.dot(eye) + beyond + to_spare_m});
  };
  side_counts_.push_back(piece.vertex_count + 1);
  side(sign * piece.normal, std::abs(d) + gap_m);
  for (int k = 0; k < piece.vertex_count; ++k) {
    const Vector3d& q = p[k + 1 < piece.vertex_count ? k + 1 : 0];
    side(sign * (p[k] - eye).cross(q - eye).normalized(), 0);
  }
}

bool NearOccluders::hide(const AlignedBox3d& box) const {
  const Vector3d centre = 0.5 * (box.min() + box.max()), half = 0.5 * (box.max() - box.min());
  const Side* side = sides_.data();
  for (const int count : side_counts_) {
    const Side* const end = side + count;
    for (; side != end; ++side) {
      if (!(side->inward.dot(centre) - side->absolute.dot(half) > side->offset)) break;
    }
    if (side == end) return true;
    side = end;
  }
  return false;
}

}  // namespace vernier::sim::internal
