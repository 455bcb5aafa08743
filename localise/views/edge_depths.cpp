// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/views/edge_depths.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/image/depth_image.h"
#include "stereo/matcher.h"

namespace vernier::localise::internal {

using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

constexpr int farthest_px = 5;       // across an edge, where depths are read
constexpr int beyond_own_px = 3;     // from where on an edge is another one
constexpr int least_depths = 3;      // of a side
constexpr int across_hole_px = 40;   // where a side without depths is looked beyond
constexpr double off_sigma = 3;      // a depth farther from the plane is of another surface
constexpr double step_share = 0.02;  // of the depth: a smaller difference of sides is no step

double sigma_of(double z_m, const DepthNoise& noise) {
  return std::hypot(noise.floor_m, noise.per_m2 * z_m * z_m);
}

/// A depth at an edge, and the variance of its noise as a multiple of one pixel's.
struct EdgeDepth {
  double z_m, noise;
};

/// A pixel beside an edge: its distance from it, and its inverse depth.
struct Beside {
  double across_px, inverse_m;
};

/// The pixels that edges touch: those less than one away, along x and y, from a point.
class EdgePixels {
 public:
  EdgePixels(const std::vector<EdgePoint>& edges, int width_px, int height_px)
      : width_px_(width_px),
        height_px_(height_px),
        is_edge_(static_cast<std::size_t>(width_px) * height_px, false) {
    for (const EdgePoint& e : edges) {
      for (const float x : {std::floor(e.pixel_px.x()), std::ceil(e.pixel_px.x())}) {
        for (const float y : {std::floor(e.pixel_px.y()), std::ceil(e.pixel_px.y())}) {
          const Eigen::Vector2i p(static_cast<int>(x), static_cast<int>(y));
          if (is_inside(p)) is_edge_[index(p)] = true;
        }
      }
    }
  }

  bool is_inside(const Eigen::Vector2i& p) const {
    return p.x() >= 0 && p.y() >= 0 && p.x() < width_px_ && p.y() < height_px_;
  }
  bool is_edge(const Eigen::Vector2i& p) const { return is_edge_[index(p)]; }

 private:
  std::size_t index(const Eigen::Vector2i& p) const {
    return static_cast<std::size_t>(p.y()) * width_px_ + p.x();
  }

  int width_px_, height_px_;
  std::vector<bool> is_edge_;
};

/// A depth map and the edges of its image.
struct EdgesWithDepth {
  const DepthImage& depth;
  const EdgePixels& edges;
  const DepthNoise& noise;
};

Eigen::Vector2i pixel_beside(const EdgePoint& e, float side, int distance_px) {
  const Eigen::Vector2f p = e.pixel_px + side * static_cast<float>(distance_px) * e.normal;
  return {static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))};
}

/// Those of known depth on one side of an edge point, up to the next edge if that leaves enough,
/// the nearest first.
std::vector<Beside> pixels_beside(const EdgesWithDepth& view, const EdgePoint& e, float side) {
  std::vector<Beside> found;
  Eigen::Vector2i last(-1, -1);
  for (int k = 1; k <= farthest_px; ++k) {
    const Eigen::Vector2i at = pixel_beside(e, side, k);
    if (at == last || !view.edges.is_inside(at)) continue;
    const bool is_other_edge = k >= beyond_own_px && view.edges.is_edge(at);
    if (is_other_edge && static_cast<int>(found.size()) >= least_depths) break;
    last = at;
    const float across = side * e.normal.dot(at.cast<float>() - e.pixel_px);
    if (const float z = view.depth(at.x(), at.y()); z > 0) found.push_back({across, 1.0 / z});
  }
  return found;
}

/// The nearest of the first depths known on one side, however far and beyond other edges; nothing
/// if there are none up to `across_hole_px`.
std::optional<double> nearest_beyond(const EdgesWithDepth& view, const EdgePoint& e, float side) {
  constexpr int enough = 3;
  std::optional<double> nearest;
  int known = 0;
  for (int k = 1; k <= across_hole_px && known < enough; ++k) {
    const Eigen::Vector2i at = pixel_beside(e, side, k);
    if (!view.edges.is_inside(at)) break;
    const float z = view.depth(at.x(), at.y());
    if (!(z > 0)) continue;
    nearest = std::min<double>(z, nearest.value_or(z));
    ++known;
  }
  return nearest;
}

EdgeDepth median(const std::vector<Beside>& pixels) {
  std::vector<double> inverse_m;
  for (const Beside& p : pixels) inverse_m.push_back(p.inverse_m);
  const auto middle = inverse_m.begin() + static_cast<long>((inverse_m.size() - 1) / 2);
  std::nth_element(inverse_m.begin(), middle, inverse_m.end());
  return {1 / *middle, 1};
}

/// The depth at the edge of a plane through the pixels, whose inverse depth is linear in the image;
/// nothing if they lie on none.
std::optional<EdgeDepth> in_plane(std::span<const Beside> pixels, const DepthNoise& noise) {
  if (static_cast<int>(pixels.size()) < least_depths) return {};
  const double n = static_cast<double>(pixels.size());
  double x = 0, y = 0, xx = 0, xy = 0;
  for (const Beside& p : pixels) x += p.across_px / n, y += p.inverse_m / n;
  for (const Beside& p : pixels) {
    xx += (p.across_px - x) * (p.across_px - x);
    xy += (p.across_px - x) * (p.inverse_m - y);
  }
  const double slope = xy / xx, at_edge = y - slope * x;
  const double sigma = y * y * sigma_of(1 / y, noise);
  for (const Beside& p : pixels) {
    if (std::abs(p.inverse_m - at_edge - slope * p.across_px) > off_sigma * sigma) return {};
  }
  if (!(at_edge > 0)) return {};
  return EdgeDepth{1 / at_edge, 1 / n + x * x / xx};
}

/// The depth of one side at an edge point; nothing if too few are known.
std::optional<EdgeDepth> depth_beside(const EdgesWithDepth& view, const EdgePoint& e, float side) {
  const std::vector<Beside> pixels = pixels_beside(view, e, side);
  if (static_cast<int>(pixels.size()) < least_depths) return {};
  if (const auto all = in_plane(pixels, view.noise)) return all;
  // the nearest may hold both sides
  if (const auto others = in_plane(std::span(pixels).subspan(1), view.noise)) return others;
  return median(pixels);
}

/// Whether the depths of both sides of an edge are of two surfaces.
bool is_step(const EdgeDepth& nearer, const EdgeDepth& farther, const DepthNoise& noise) {
  const DepthNoise of_both{noise.floor_m * std::sqrt(nearer.noise + farther.noise),
                           noise.per_m2 * std::numbers::sqrt2};
  return farther.z_m - nearer.z_m >
         std::max(off_sigma * sigma_of(nearer.z_m, of_both), step_share * nearer.z_m);
}

/// The depth of an edge point: the nearer one at a step. Where one side is not known, the other is
/// taken only if what is beyond is known not to be nearer: a surface that gives no depth, as a dark
/// one, would else get that of its background.
std::optional<EdgeDepth> depth_at(const EdgesWithDepth& view, const EdgePoint& e) {
  const auto dark = depth_beside(view, e, -1), bright = depth_beside(view, e, 1);
  if (!dark && !bright) return {};
  if (!dark || !bright) {
    const EdgeDepth known = dark ? *dark : *bright;
    const auto beyond = nearest_beyond(view, e, dark ? 1 : -1);
    if (!beyond || is_step({*beyond, 1}, known, view.noise)) return {};
    return known;
  }
  const auto [nearer, farther] =
      dark->z_m < bright->z_m ? std::pair(*dark, *bright) : std::pair(*bright, *dark);
  if (is_step(nearer, farther, view.noise)) return nearer;
  return EdgeDepth{(dark->z_m + bright->z_m) / 2, (dark->noise + bright->noise) / 4};
}

}  // namespace

std::vector<EdgeDisparity> inverse_depths(const std::vector<EdgePoint>& edges,
                                          const DepthImage& depth,
                                          double f_px,
                                          const DepthNoise& noise) {
  const EdgePixels pixels(edges, depth.width_px, depth.height_px);
  const EdgesWithDepth view{depth, pixels, noise};
  std::vector<EdgeDisparity> found(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    found[i].disparity_px = std::numeric_limits<float>::quiet_NaN();
    const std::optional<EdgeDepth> at = depth_at(view, edges[i]);
    if (!at) continue;
    const DepthNoise here{noise.floor_m * std::sqrt(std::max(1.0, at->noise)), noise.per_m2};
    found[i].disparity_px = static_cast<float>(f_px / at->z_m);
    found[i].sigma_px = static_cast<float>(f_px / (at->z_m * at->z_m) * sigma_of(at->z_m, here));
    found[i].confidence = 1;
  }
  return found;
}

}  // namespace vernier::localise::internal
