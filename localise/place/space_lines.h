// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "localise/place.h"

namespace vernier::localise::internal {

/// Lines in space by columns, for kernels over many of them: ends in metres in one robot frame, the
/// standard deviation of the distance, and whether a line counts when it is not seen again. The
/// columns are as long as a multiple of 16, with lines behind the robot at the end.
struct SpaceLines {
  std::vector<float> ax, ay, az, bx, by, bz, sigma_m, counted;
  std::size_t size = 0;

  void add(const Eigen::Vector3f& a_m, const Eigen::Vector3f& b_m, float sigma, bool is_counted);
  /// Fills up the columns; needed after the last add().
  void pad();
  Eigen::Vector3f a_m(std::size_t i) const { return {ax[i], ay[i], az[i]}; }
  Eigen::Vector3f b_m(std::size_t i) const { return {bx[i], by[i], bz[i]}; }
};

/// All lines of a view, counted.
SpaceLines space_lines(std::span<const PlaceLine> lines);

}  // namespace vernier::localise::internal
