// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "calib/pose.h"
#include "localise/joined_lines.h"
#include "sim/built/planar_patches.h"
#include "sim/world.h"

namespace vernier::sim::internal {

struct BuiltWorldOptions {
  /// Views that must have seen a line. An edge that one view saw and its neighbours did not is as
  /// likely a shadow, a gleam, a wrong depth or the outline of something round.
  int min_sightings = 2;
  double shortest_m = 0.02;  ///< of a line
  /// Lines that lean by less, and by no more than their covariance allows, are upright exactly
  /// (upright_line.h): fitted ones never are, and the ceiling goes by exactly upright ones. 0:
  /// none.
  double upright_rad = 2 * std::numbers::pi / 180;
  /// Surfaces stand back from the cameras by this much, so that their noise does not hide the lines
  /// that lie on them: lines and depths err by centimetres, and what is a line's width behind a
  /// surface would not be seen at all.
  double recede_m = 0.05;
  double floor_m = 0.1;  ///< level patches within this of height 0 are the floor
  /// Nothing stands nearer to the cameras' places and to the route between them, on the floor plan.
  double walked_m = 0.2;
};

struct BuiltWorldReport {
  std::size_t joined = 0;      ///< lines that were joined, of any number of sightings
  std::size_t lines = 0;       ///< in the world
  std::size_t upright = 0;     ///< of them made upright
  std::size_t surfaces = 0;    ///< in the world
  std::size_t on_the_way = 0;  ///< patches left out, where the cameras passed
  /// Height of the lowest level surface of 1 m² at least, where depths show one.
  std::optional<double> floor_m;
};

struct BuiltWorld {
  WorldDescription world;     ///< its loose segments are lines, in this order
  std::vector<int> of_lines;  ///< of each: its index in JoinedLines::lines
  BuiltWorldReport report;
};

/// A world of joined lines and of patches of surfaces; the way of the cameras (z up, the floor at
/// 0) is its route, and free.
BuiltWorld built_world(const localise::JoinedLines& lines,
                       const std::vector<Patch>& patches,
                       std::span<const Pose> T_world_camera,
                       const BuiltWorldOptions& options = {});

}  // namespace vernier::sim::internal
