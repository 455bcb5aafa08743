// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/visibility/shadow_grid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "calib/pose.h"
#include "sim/visibility/convex_pieces.h"
#include "sim/visibility/shadow.h"
#include "sim/visibility/tile_walk.h"
#include "sim/visibility/view_frustum.h"

namespace vernier::sim::internal {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double eye_depth_m = 1e-6;  ///< surfaces closer to the eye hide nothing
constexpr double box_slack = 1e-7;    ///< normalised; larger than rounding and any tolerance
constexpr int max_sides_in_mask = 32;

void extend(ImageBox& box, const Eigen::Vector2d& x) {
  box = {std::min(box.x0, x[0]), std::min(box.y0, x[1]), std::max(box.x1, x[0]),
         std::max(box.y1, x[1])};
}

/// The bounding box of a polygon's projection, of its part in front of the eye.
ImageBox picture_box(std::span<const Eigen::Vector3d> polygon) {
  ImageBox box{infinite, infinite, -infinite, -infinite};
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d &p = polygon[i], &q = polygon[i + 1 < polygon.size() ? i + 1 : 0];
    const bool p_ahead = p.z() > eye_depth_m, q_ahead = q.z() > eye_depth_m;
    if (p_ahead) extend(box, p.head<2>() / p.z());
    if (p_ahead != q_ahead) {
      const double t = (eye_depth_m - p.z()) / (q.z() - p.z());
      extend(box, (p + t * (q - p)).head<2>() / eye_depth_m);
    }
  }
  return {box.x0 - box_slack, box.y0 - box_slack, box.x1 + box_slack, box.y1 + box_slack};
}

bool overlap(const ImageBox& a, const ImageBox& b) {
  return a.x0 <= b.x1 && b.x0 <= a.x1 && a.y0 <= b.y1 && b.y0 <= a.y1;
}

/// Inward unit normals of the four sides of the pyramid over a box.
std::array<Eigen::Vector3d, 4> pyramid(const ImageBox& box) {
  return {Eigen::Vector3d(1, 0, -box.x0).normalized(), Eigen::Vector3d(-1, 0, box.x1).normalized(),
          Eigen::Vector3d(0, 1, -box.y0).normalized(), Eigen::Vector3d(0, -1, box.y1).normalized()};
}

}  // namespace

void ShadowGrid::set_raster(const ImageBox& outer) {
  origin_ = {outer.x0, outer.y0};
  tile_size_ = {(outer.x1 - outer.x0) / columns, (outer.y1 - outer.y0) / rows};
  tiles_per_unit_ = tile_size_.cwiseInverse();
  inverse_covered_.assign(columns * rows, 0.0);
  outside_.resize((columns + 1) * (rows + 1));
  not_inside_.resize((columns + 1) * (rows + 1));
}

ShadowGrid::TileRange ShadowGrid::tiles_of(const ImageBox& box) const {
  const auto tile = [&](double x, int axis, int count) {
    const double at = (x - origin_[axis]) * tiles_per_unit_[axis];
    return static_cast<int>(std::clamp(at, 0.0, count - 1.0));
  };
  return {tile(box.x0, 0, columns), tile(box.x1, 0, columns), tile(box.y0, 1, rows),
          tile(box.y1, 1, rows)};
}

void ShadowGrid::build(const ConvexSurfaces& surfaces,
                       const std::vector<int>& near,
                       const Pose& T_camera_world,
                       const ViewFrustum& frustum,
                       double gap_m) {
  gap_m_ = gap_m;
  set_raster(frustum.outer());
  collect(surfaces, near, T_camera_world, frustum);
  std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& u, const Candidate& v) {
    return u.inverse_nearest != v.inverse_nearest ? u.inverse_nearest > v.inverse_nearest
                                                  : u.index < v.index;
  });
  casters_.clear();
  sides_.clear();
  entries_.clear();
  for (const Candidate& candidate : candidates_) cast(candidate);
  for (Occluder& caster : casters_) {
    caster.shadow.sides = {sides_.data() + caster.first_side,
                           static_cast<std::size_t>(caster.side_count)};
  }
  sort_into_tiles();
  tried_.assign(casters_.size(), 0);
  segment_ = 0;
}

void ShadowGrid::collect(const ConvexSurfaces& surfaces,
                         const std::vector<int>& near,
                         const Pose& T,
                         const ViewFrustum& frustum) {
  candidates_.clear();
  vertices_.clear();
  const auto sides = pyramid(frustum.outer());
  for (const int i : near) {
    const ConvexSurface& piece = surfaces.pieces[i];
    const Eigen::Vector3d centre = T * piece.centre_m;
    const double r = piece.radius_m + box_slack;
    if (centre.z() < -r || centre.z() > frustum.far_m() + r) continue;
    if (std::any_of(sides.begin(), sides.end(),
                    [&](const Eigen::Vector3d& side) { return side.dot(centre) < -r; })) {
      continue;
    }
    append_candidate(piece, i,
                     {surfaces.vertices_m.data() + piece.first_vertex,
                      static_cast<std::size_t>(piece.vertex_count)},
                     T, frustum.outer());
  }
}

void ShadowGrid::append_candidate(const ConvexSurface& piece,
                                  int index,
                                  std::span<const Eigen::Vector3d> vertices,
                                  const Pose& T,
                                  const ImageBox& outer) {
  Candidate candidate;
  candidate.normal = T.R * piece.normal;
  candidate.distance_m = piece.distance_m + candidate.normal.dot(T.t);
  if (std::abs(candidate.distance_m) <= edge_on_m) return;
  candidate.index = index;
  candidate.first_vertex = static_cast<int>(vertices_.size());
  candidate.vertex_count = piece.vertex_count;
  double nearest = infinite;
  for (const Eigen::Vector3d& vertex : vertices) {
    vertices_.push_back(T * vertex);
    nearest = std::min(nearest, vertices_.back().z());
  }
  const auto first = vertices_.begin() + candidate.first_vertex;
  candidate.box = picture_box({first, vertices_.end()});
  if (!overlap(candidate.box, outer)) {
    vertices_.erase(first, vertices_.end());
    return;
  }
  candidate.inverse_nearest = nearest > eye_depth_m ? 1 / nearest : infinite;
  if (candidate.distance_m < 0) {
    candidate.normal = -candidate.normal;
    candidate.distance_m = -candidate.distance_m;
    std::reverse(first, vertices_.end());
  }
  candidates_.push_back(candidate);
}

void ShadowGrid::cast(const Candidate& candidate) {
  const TileRange range = tiles_of(candidate.box);
  bool reaches = false;
  for (int row = range.row0; row <= range.row1 && !reaches; ++row) {
    for (int column = range.column0; column <= range.column1 && !reaches; ++column) {
      reaches = candidate.inverse_nearest >= inverse_covered_[row * columns + column];
    }
  }
  if (!reaches) return;

  Occluder caster{{candidate.normal, candidate.distance_m, {}},
                  candidate.inverse_nearest,
                  candidate.box,
                  static_cast<int>(sides_.size()),
                  candidate.vertex_count};
  for (int i = 0; i < candidate.vertex_count; ++i) {
    const int next = i + 1 < candidate.vertex_count ? i + 1 : 0;
    sides_.push_back(shadow_side(vertices_[candidate.first_vertex + i],
                                 vertices_[candidate.first_vertex + next]));
  }
  const bool wide = range.column1 > range.column0 && range.row1 > range.row0 &&
                    candidate.vertex_count <= max_sides_in_mask;
  if (wide) {
    mark_lattice(range,
                 {sides_.data() + caster.first_side, static_cast<std::size_t>(caster.side_count)});
  }
  const int index = static_cast<int>(casters_.size());
  for (int row = range.row0; row <= range.row1; ++row) {
    for (int column = range.column0; column <= range.column1; ++column) {
      const int tile = row * columns + column;
      if (candidate.inverse_nearest < inverse_covered_[tile]) continue;
      if (wide && !cover_or_miss(candidate, column, row)) continue;
      entries_.emplace_back(tile, index);
    }
  }
  casters_.push_back(caster);
}

void ShadowGrid::mark_lattice(const TileRange& range, std::span<const ShadowSide> sides) {
  for (int row = range.row0; row <= range.row1 + 1; ++row) {
    const int line = row * (columns + 1);
    std::fill(outside_.begin() + line + range.column0, outside_.begin() + line + range.column1 + 2,
              0);
    std::fill(not_inside_.begin() + line + range.column0,
              not_inside_.begin() + line + range.column1 + 2, 0);
    const double y = origin_[1] + row * tile_size_[1];
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const Eigen::Vector3d& n = sides[i].inward;
      // On the unit plane; large enough that points from 1 cm on are clear of the side's tolerance.
      const double margin = 100 * sides[i].tolerance;
      const double constant = n.y() * y + n.z() + n.x() * origin_[0];
      const double step = n.x() * tile_size_[0];
      for (int column = range.column0; column <= range.column1 + 1; ++column) {
        const double f = constant + column * step;
        outside_[line + column] |= static_cast<std::uint32_t>(f < -margin) << i;
        not_inside_[line + column] |= static_cast<std::uint32_t>(!(f > margin)) << i;
      }
    }
  }
}

bool ShadowGrid::cover_or_miss(const Candidate& candidate, int column, int row) {
  const int k = row * (columns + 1) + column, below = k + columns + 1;
  if (outside_[k] & outside_[k + 1] & outside_[below] & outside_[below + 1]) return false;
  if (not_inside_[k] | not_inside_[k + 1] | not_inside_[below] | not_inside_[below + 1])
    return true;
  // On the plane 1 / z = n·(x, y, 1) / d, so the farthest point is at the corner with least n·(…).
  const Eigen::Vector3d& n = candidate.normal;
  const double x = origin_[0] + (column + (n.x() < 0)) * tile_size_[0];
  const double y = origin_[1] + (row + (n.y() < 0)) * tile_size_[1];
  const double least = n.x() * x + n.y() * y + n.z();
  // A point at z times the depth of the plane on its ray lies (z - 1) d beyond the plane.
  const double inverse = least / (candidate.distance_m + gap_m_) * (1 - 1e-9);
  double& covered = inverse_covered_[row * columns + column];
  covered = std::max(covered, inverse);
  return true;
}

void ShadowGrid::sort_into_tiles() {
  tile_begin_.assign(columns * rows + 1, 0);
  const auto needed = [&](const std::pair<int, int>& entry) {
    return casters_[entry.second].inverse_nearest >= inverse_covered_[entry.first];
  };
  for (const auto& entry : entries_) tile_begin_[entry.first + 1] += needed(entry);
  for (int tile = 0; tile < columns * rows; ++tile) tile_begin_[tile + 1] += tile_begin_[tile];
  tile_casters_.resize(tile_begin_.back());
  // Filled from the back, so that every tile is sorted nearest first and its begin index ends up
  // right.
  std::vector<int>& end = tile_begin_;
  for (int tile = 0; tile < columns * rows; ++tile) end[tile] = end[tile + 1];
  for (std::size_t i = entries_.size(); i-- > 0;) {
    if (needed(entries_[i])) tile_casters_[--end[entries_[i].first]] = entries_[i].second;
  }
}

/// A segment traversing the tiles, with the parts of it known to be hidden.
struct ShadowGrid::Traverse {
  const Eigen::Vector3d &a, &b;
  Stretch& open;
  std::vector<OccludedInterval>& hidden;
  ImageBox box;

  /// Records a hidden interval; false if nothing is left open.
  bool close(const OccludedInterval& h) {
    if (h.hands == OccludedInterval::both && h.t1 - h.t0 > touching) {
      if (h.t0 <= open.t0 + touching) {
        open.t0 = std::max(open.t0, h.t1);
        return open.t1 - open.t0 > min_stretch;
      }
      if (h.t1 >= open.t1 - touching) {
        open.t1 = std::min(open.t1, h.t0);
        return open.t1 - open.t0 > min_stretch;
      }
    }
    if (h.hands) hidden.push_back(h);
    return true;
  }
};

bool ShadowGrid::covers_slab(const TileWalk& walk) const {
  for (int minor = walk.first_minor(); minor <= walk.last_minor(); ++minor) {
    if (walk.inverse_nearest() >= inverse_covered_[walk.tile(minor)]) return false;
  }
  return true;
}

bool ShadowGrid::hide_in_slab(Traverse& traverse, const TileWalk& walk) {
  for (int minor = walk.first_minor(); minor <= walk.last_minor(); ++minor) {
    const int tile = walk.tile(minor);
    for (int k = tile_begin_[tile]; k < tile_begin_[tile + 1]; ++k) {
      const int index = tile_casters_[k];
      const Occluder& caster = casters_[index];
      if (caster.inverse_nearest <= walk.inverse_farthest())
        break;  // this and all following are behind
      if (tried_[index] == segment_) continue;
      tried_[index] = segment_;
      if (!overlap(caster.box, traverse.box)) continue;
      const OccludedInterval h = occluded_interval(caster.shadow, traverse.a, traverse.b,
                                                   traverse.open.t0, traverse.open.t1, gap_m_);
      if (h.hands && !traverse.close(h)) return false;
    }
  }
  return true;
}

bool ShadowGrid::hide(const Eigen::Vector3d& a,
                      const Eigen::Vector3d& b,
                      Stretch& open,
                      std::vector<OccludedInterval>& hidden) {
  hidden.clear();
  ++segment_;
  const ProjectedSegment picture(a, b, open);
  Traverse traverse{
      a, b, open, hidden, {picture.x0[0], picture.x0[1], picture.x0[0], picture.x0[1]}};
  extend(traverse.box, picture.x1);
  TileWalk walk(picture, origin_, tiles_per_unit_, {columns, rows});
  double covered_from = -1;
  do {
    const bool covered = covers_slab(walk);
    if (covered && covered_from < 0) covered_from = walk.s0();
    if (!covered && !hide_in_slab(traverse, walk)) return false;
    if (covered_from >= 0 && (!covered || walk.at_last())) {
      const double t1 = picture.t_at(covered ? walk.s1() : walk.s0());
      if (!traverse.close({picture.t_at(covered_from), t1, OccludedInterval::both})) return false;
      covered_from = -1;
    }
  } while (walk.next());
  return true;
}

bool ShadowGrid::hides(const Eigen::Vector3d& point) const {
  const Eigen::Vector2d g =
      (Eigen::Vector2d(point.head<2>() / point.z()) - origin_).cwiseProduct(tiles_per_unit_);
  const int tile = clamp_tile(g[1], rows) * columns + clamp_tile(g[0], columns);
  if (1 / point.z() < inverse_covered_[tile]) return true;
  bool on_border = false;
  for (int k = tile_begin_[tile]; k < tile_begin_[tile + 1]; ++k) {
    const PointInShadow where = point_in_shadow(casters_[tile_casters_[k]].shadow, point, gap_m_);
    if (where == PointInShadow::inside) return true;
    on_border |= where == PointInShadow::on_border;
  }
  if (!on_border) return false;
  std::vector<Eigen::Vector3d> touched;
  if (classify(point, &touched) == PointInShadow::inside) return true;
  const auto around = points_around(point, touched);
  return std::none_of(around.begin(), around.end(), [&](const Eigen::Vector3d& x) {
    return classify(x) == PointInShadow::outside;
  });
}

PointInShadow ShadowGrid::classify(const Eigen::Vector3d& point,
                                   std::vector<Eigen::Vector3d>* touched) const {
  PointInShadow result = PointInShadow::outside;
  for (const Occluder& caster : casters_) {
    const PointInShadow where = point_in_shadow(caster.shadow, point, gap_m_, touched);
    if (where == PointInShadow::inside) return where;
    if (where == PointInShadow::on_border) result = where;
  }
  return result;
}

}  // namespace vernier::sim::internal
