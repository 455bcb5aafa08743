// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "calib/pose.h"
#include "sim/visibility/convex_pieces.h"
#include "sim/visibility/shadow.h"
#include "sim/visibility/tile_walk.h"
#include "sim/visibility/view_frustum.h"

namespace vernier::sim::internal {

/// The shadows of one view's surfaces, sorted into image tiles.
///
/// A tile lists the shadows that overlap it, nearest first. If one piece covers a whole tile,
/// everything in the tile beyond that piece's farthest point there, plus the gap, is hidden: this
/// depth is stored, and pieces behind it are dropped, since they hide nothing more. May be rebuilt
/// for every view to reuse its memory.
class ShadowGrid {
 public:
  /// `near`: indices of the pieces that can be in the viewing volume, ascending.
  void build(const ConvexSurfaces& surfaces,
             const std::vector<int>& near,
             const Pose& T_camera_world,
             const ViewFrustum& frustum,
             double gap_m);

  /// Hidden parts of the interval `open` of the segment a b (camera frame, `open` from
  /// ViewFrustum::clip). Hidden parts at its ends are cut off `open`, the others are added to
  /// `hidden`. Returns false if nothing is left; `open` and `hidden` are then invalid.
  bool hide(const Eigen::Vector3d& a,
            const Eigen::Vector3d& b,
            Stretch& open,
            std::vector<OccludedInterval>& hidden);

  /// Whether a point (camera frame, in the frustum) is hidden.
  bool hides(const Eigen::Vector3d& point) const;

 private:
  static constexpr int columns = 16, rows = 12;
  struct Traverse;

  struct Candidate {
    double inverse_nearest;  ///< 1 / depth of its nearest vertex; infinite at or behind the eye's
                             ///< depth
    int index;               ///< index into the convex surfaces
    int first_vertex, vertex_count;
    Eigen::Vector3d normal;
    double distance_m;
    ImageBox box;
  };
  struct Occluder {
    Shadow shadow;
    double inverse_nearest;
    ImageBox box;
    int first_side, side_count;
  };
  struct TileRange {
    int column0, column1, row0, row1;  ///< inclusive
  };

  void set_raster(const ImageBox& outer);
  void collect(const ConvexSurfaces& surfaces,
               const std::vector<int>& near,
               const Pose& T,
               const ViewFrustum& frustum);
  void append_candidate(const ConvexSurface& piece,
                        int index,
                        std::span<const Eigen::Vector3d> vertices,
                        const Pose& T,
                        const ImageBox& outer);
  void cast(const Candidate& candidate);
  void mark_lattice(const TileRange& range, std::span<const ShadowSide> sides);
  bool cover_or_miss(const Candidate& candidate, int column, int row);
  void sort_into_tiles();
  TileRange tiles_of(const ImageBox& box) const;
  bool hide_in_slab(Traverse& traverse, const TileWalk& walk);
  bool covers_slab(const TileWalk& walk) const;
  PointInShadow classify(const Eigen::Vector3d& point,
                         std::vector<Eigen::Vector3d>* touched = nullptr) const;

  double gap_m_ = 0;
  Eigen::Vector2d origin_, tile_size_, tiles_per_unit_;
  std::vector<Eigen::Vector3d> vertices_;
  std::vector<Candidate> candidates_;
  std::vector<Occluder> casters_;
  std::vector<ShadowSide> sides_;
  std::vector<std::uint32_t> outside_, not_inside_;  ///< one bit per side, for every tile corner
  std::vector<std::pair<int, int>> entries_;         ///< (tile, caster)
  /// One per tile: 1 / depth beyond which everything is hidden.
  std::vector<double> inverse_covered_;
  std::vector<int> tile_begin_, tile_casters_;
  std::vector<std::uint32_t> tried_;  ///< one per caster: the last segment it was tested on
  std::uint32_t segment_ = 0;
};

}  // namespace vernier::sim::internal
