// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/edges/edge_points_by_row.h"

namespace vernier::stereo::internal {

/// Drops points in groups smaller than `min_points`. A group is a chain of matched points within
/// reach of each other in row and column whose disparities differ by at most one, plus `slope` for
/// every column between them.
void remove_isolated(const PointsByRow& points,
                     int min_points,
                     int reach,
                     double slope,
                     std::vector<float>& disparity);

}  // namespace vernier::stereo::internal
