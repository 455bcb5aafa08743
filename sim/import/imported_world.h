// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/import/axes_and_unit.h"
#include "sim/import/crease_edges.h"
#include "sim/import/mesh.h"
#include "sim/world.h"

namespace vernier::sim::internal {

struct ImportOptions {
  std::optional<int> up_axis;     ///< 0 to 2; else by the file or its looks
  std::optional<double> unit_m;   ///< metres of a unit of the file
  int storey = 1;                 ///< from the lowest, of those found
  std::optional<double> floor_m;  ///< height of the floor in the file, instead of a storey
  std::optional<double> top_m;    ///< how high above the floor the world ends
  double crease_deg = 20;         ///< surfaces that meet at a smaller angle make no edge
  double shortest_m = 0.1;        ///< shorter edges are left out
  double upright_deg = 0.3;       ///< edges that lean by at most this become upright; 0: none
  bool is_level = false;          ///< known to stand level, so that it is not levelled
};

struct ImportReport {
  AxesAndUnit axes;
  std::vector<double> storeys_m;  ///< floors that were found, heights in the file's axes
  double floor_m = 0;             ///< of the one that was taken
  std::optional<double> top_m;    ///< where it ends, in the file's axes
  Eigen::Vector2d moved_m = Eigen::Vector2d::Zero();   ///< subtracted from coordinates of the plan
  std::size_t vertices = 0, triangles = 0, lines = 0;  ///< of the file
  std::size_t edges = 0;                               ///< that one would see, of all storeys
  std::size_t outside = 0;                             ///< of them above or below the storey
  std::size_t below = 0;                               ///< of these below it
  std::size_t shorter = 0;                             ///< of them left out
  CreaseRemarks creases;                               ///< of all storeys
  std::size_t made_upright = 0;                        ///< of those in the world
  double levelled_deg = 0;                             ///< by which the building leaned
  double floor_slope_deg = 0;                          ///< what is left, floor_slope_rad()
};

struct ImportedWorld {
  WorldDescription world;  ///< no route yet
  ImportReport report;
};

/// A world of one storey of a building: its edges (crease_edges), the corners where they meet, its
/// surfaces (convex_faces), with the floor at z = 0. A building that leans (leaning_up) is
/// levelled unless it is known to stand level or a height of its floor is given; and edges that are
/// nearly upright become so, which the world's ceiling goes by, if no end leaves its surfaces by it
/// (VisibilityOptions::surface_gap_m). The plan keeps its coordinates unless they are more than 1
/// km from the origin. All features are loose ones. Throws Error(place) where nothing is left, for
/// too many triangles, coordinates that are not finite, and as axes_and_unit() does.
ImportedWorld import_world(const Mesh& mesh,
                           const ImportOptions& options,
                           const std::string& place);

}  // namespace vernier::sim::internal
