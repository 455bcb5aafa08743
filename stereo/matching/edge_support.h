// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "stereo/edges/edge_points_by_row.h"
#include "stereo/matching/census.h"

namespace vernier::stereo::internal {

/// Where a disparity has no place in the other image.
constexpr std::int16_t no_place_cost = 560;

/// Whether two images are walked through in the same direction, or the other one is mirrored.
enum class Facing { same, opposite };

/// Another image stretched along its rows.
struct StretchedView {
  double scale = 1;  ///< place p of the other image is at scale p here
  CensusImage image;
};

/// Costs of points at their places in another image: Hamming distances of the 3 x 3 census words
/// about both, summed, 0 to 558. The places of a point are first_place + k, k from 0, so that
/// disparities grow with k: seen from the left image the right one is mirrored,
///
///     from the left:    other = mirrored right,  first place = width − 1 − x + least disparity
///     from the right:   other = left,            first place = x + least disparity
///
/// `disparities` is a multiple of 32, and all places are within the images' border.
struct CensusCosts {
  const PointsByRow& points;
  const CensusImage &own, &other;
  const std::vector<int>& first_place;
  Facing facing = Facing::same;
  int disparities = 0;
  /// The other image stretched, for surfaces that slant: a point's cost is the least of all, with
  /// `stretched_penalty` added to these.
  const std::vector<StretchedView>* stretched = nullptr;
  int stretched_penalty = 30;
};

/// The scale whose cost is the least of a point at a place, 1 for the image as it is.
double best_scale(const CensusCosts& at, int point, int index);

/// Those of one point, into `costs`.
void census_costs(const CensusCosts& at, int point, std::int16_t* costs);

/// The directions in which support comes.
enum class Support { all, from_above };

struct SupportOptions {
  int small_step = 120;    ///< added where neighbours differ by one disparity
  int large_step = 350;    ///< added where they differ by more
  double reach_px = 12;    ///< distance over which a neighbour's support fades …
  double min_share = 0.1;  ///< … to this share; at twice the reach it ends
  double slope = 0;  ///< change of disparity a pixel that counts as a small step, from a pixel on
};

/// The disparity that support chooses for a point.
struct Winner {
  int index = 0;     ///< among those searched
  float offset = 0;  ///< of the vertex of the parabola through it and its neighbours
  float margin = 0;  ///< how much worse the best is that is not beside it, relative
};

/// Semi-global support (Hirschmüller 2008) between points instead of pixels: along eight
/// directions r, from each neighbour n at distance g,
///
///     L_r(p, d) = C(p, d) + min( L_r(n, d), L_r(n, d ± 1) + w P_1, min L_r(n) + w P_2 ) − min
///     L_r(n)
///
/// with w falling from 1 to `min_share` over the reach; C(p, d) alone where there is none. A
/// point gets the disparity of the least Σ_r L_r, the smallest of equal ones.
/// From above alone, four of the directions count, in a single pass.
std::vector<Winner> semi_global_disparities(const CensusCosts& costs,
                                            Support support = Support::all,
                                            const SupportOptions& options = {});

}  // namespace vernier::stereo::internal
