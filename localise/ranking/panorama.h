// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "localise/place.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

/// Bins of what is seen around a robot: bearing x (upright or not, height, logarithm of the range).
struct PanoramaBins {
  static constexpr int bearings = 64;  ///< of the whole circle
  static constexpr int heights = 4;
  static constexpr double highest_m = 2.5;
  static constexpr int ranges = 8;  ///< in equal ratios
  static constexpr double nearest_m = 0.4, furthest_m = 10;
  static constexpr int channels = 2 * heights * ranges;
};

/// Bearings of the horizontal field of view of a map's rig, in bins; that of 640 px at 525 px
/// without a rig.
int bearings_in_view(const TopologicalMap& map);

/// Length of a view's lines in the image, shared out among the bins of the field of view (in
/// proportion to their nearness), smoothed over bearings, square-rooted and of unit length:
/// `bearings` x channels. All 0 without lines.
std::vector<float> view_descriptor(std::span<const PlaceLine> lines, int bearings);

/// The same around a position of the map, in the world's directions, from all views there. Parts
/// of the circle of which nothing is known are left out.
struct Panorama {
  Pose2D at;                       ///< heading 0
  std::vector<std::uint8_t> bins;  ///< roots in equal steps up to the largest: bearings x channels
  /// Fields of view that are known: the bearing in `bins` at which one begins, its bearing in the
  /// world, and the inverse of its norm in steps.
  struct Window {
    std::uint16_t begin = 0, bearing = 0;
    float per_norm = 0;
  };
  std::vector<Window> windows;
};

/// Panoramas at the position of some views, the first, and beside it, where lines are seen from
/// another side.
std::vector<Panorama> panoramas(std::span<const MapNode* const> views, int bearings_in_view);

/// A heading at which a panorama looks like a view.
struct PanoramaMatch {
  float likeness = 0;  ///< Bhattacharyya coefficient
  float heading_rad = 0;
};

/// The best of a panorama's windows that begin at most `reach` bins from a bearing; likeness 0
/// without any.
PanoramaMatch best_match(std::span<const float> view_descriptor,
                         const Panorama& panorama,
                         int bearing,
                         int reach);

/// Dot products of a view's descriptor with the windows from a first one on, in steps. SIMD
/// selected at run time (calib/base/instruction_set.h).
void window_products(std::span<const float> view,
                     const Panorama& panorama,
                     std::size_t first,
                     std::span<float> products);

}  // namespace vernier::localise::internal
