// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "calib/rig.h"

namespace vernier {

/// The matched corners of two simultaneous images: consecutive rows of PairObservations.
struct ImagePair {
  int number = 0;
  std::size_t first = 0, count = 0;
};

/// Corners of an arbitrary scene matched between simultaneous images of a left and a right camera;
/// their positions in space are unknown.
struct PairObservations {
  std::vector<ImagePair> image_pairs;      ///< of distinct numbers, in the order of their rows
  std::vector<Eigen::Vector4d> pixels_px;  ///< u_left, v_left, u_right, v_right
  /// Standard deviation of a coordinate: one per row, or a single one for all. Empty: 1 px.
  std::vector<float> sigma_px;

  double sigma_of(std::size_t row) const {
    return sigma_px.empty() ? 1 : sigma_px[sigma_px.size() == 1 ? 0 : row];
  }
  std::size_t size() const { return pixels_px.size(); }
};

/// Adds a match to image pair `number`, which must be the last one or a new one.
void add_pair(PairObservations& pairs,
              int number,
              const Eigen::Vector4d& pixels_px,
              double sigma_px);

/// Adds all of `more` as separate image pairs; one with a number in use gets the smallest free one.
void append(PairObservations& pairs, const PairObservations& more);

/// The rows with `kept` set; image pairs without any are dropped. Throws Error unless `kept` has a
/// flag per row, and the image pairs hold every row once, in order.
PairObservations selected(const PairObservations& pairs, const std::vector<bool>& kept);

/// Checks that the pairs can be used for calibration: two cameras, image pairs that hold every row
/// once, in order, pixels finite and inside the images, noise above 0 and finite (none, one or one
/// per row), no repeated match. Throws Error naming the row as a line of the file `place` (rows
/// begin on its second line), or by its number if `place` is empty.
void check_pairs(const PairObservations& pairs, const Rig& rig, const std::string& place = "");

}  // namespace vernier
