// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "stereo/edges/edge_points_by_row.h"
#include "stereo/matching/census.h"
#include "stereo/matching/side_levels.h"

namespace vernier::stereo::internal {

/// What a difference of one grey level on one side of an edge, beyond the tolerance, adds to a
/// cost, up to a difference of so many: more says no more, as behind an outline the two cameras see
/// different surfaces.
constexpr std::int16_t side_weight = 3, most_side_levels = 12;

/// Cost of a disparity whose position lies outside the other image: above all others.
constexpr std::int16_t no_place_cost = 560 + 2 * side_weight * most_side_levels;

/// Whether both images are scanned in the same direction, or the other one is mirrored.
enum class Facing { same, opposite };

/// The other image stretched along its rows.
struct StretchedView {
  double scale = 1;  ///< position p of the other image maps to scale p here
  CensusImage image;
  LevelImage levels = {};  ///< if costs have sides
};

/// Matching costs of points at positions in the other image: summed Hamming distances of 3 x 3
/// census words around both, 0 to 558, and with `sides` the differences of the grey levels on both
/// sides of the edge there. The census bears any difference of exposure, but sees no contrast: it
/// takes one outline of a plain frame for another, which the levels tell apart (both together: Mei
/// et al., "On building an accurate stereo matching system on graphics hardware", 2011). The
/// positions of a point are first_place + k, k from 0;
/// disparities increase with k because the right image is mirrored when searched from the left:
///
///     from the left:    other = mirrored right,  first place = width − 1 − x + least disparity
///     from the right:   other = left,            first place = x + least disparity
///
/// `disparities` is a multiple of 32, and all positions lie within the padded images.
struct CensusCosts {
  const PointsByRow& points;
  const CensusImage &own, &other;
  const std::vector<int>& first_place;
  Facing facing = Facing::same;
  int disparities = 0;
  /// Stretched versions of the other image, for slanted surfaces: a point's cost is the minimum
  /// over all versions, with `stretched_penalty` added to these.
  const std::vector<StretchedView>* stretched = nullptr;
  int stretched_penalty = 30;
  const SideLevels* sides = nullptr;
};

/// The scale with the minimum cost of a point at a position, 1 for the unstretched image.
double best_scale(const CensusCosts& at, int point, int index);

/// All costs of one point, into `costs`.
void census_costs(const CensusCosts& at, int point, std::int16_t* costs);

/// Directions of aggregation.
enum class Support { all, from_above };

struct SupportOptions {
  int small_step = 120;    ///< penalty for neighbours that differ by one disparity
  int large_step = 350;    ///< penalty for neighbours that differ by more
  double reach_px = 12;    ///< distance at which a neighbour's weight has fallen …
  double min_share = 0.1;  ///< … to this fraction; 0 at twice the distance
  double slope = 0;  ///< change of disparity a pixel that counts as a small step, from a pixel on
};

/// The disparity selected for a point.
struct Winner {
  int index = 0;     ///< index into the searched disparities
  float offset = 0;  ///< vertex of the parabola through it and its neighbours, relative to it
  float margin = 0;  ///< relative excess cost of the best non-adjacent disparity
};

/// Semi-global aggregation (Hirschmüller 2008) between points instead of pixels: along eight
/// directions r, from each neighbour n at distance g,
///
///     L_r(p, d) = C(p, d) + min( L_r(n, d), L_r(n, d ± 1) + w P_1, min L_r(n) + w P_2 ) − min
///     L_r(n)
///
/// with w falling from 1 to `min_share` over the reach; C(p, d) alone if there is no neighbour. A
/// point gets the disparity with the smallest Σ_r L_r, the smallest disparity if tied. With
/// neighbours from above only, four of the directions are used, in a single pass.
std::vector<Winner> semi_global_disparities(const CensusCosts& costs,
                                            Support support = Support::all,
                                            const SupportOptions& options = {});

}  // namespace vernier::stereo::internal
