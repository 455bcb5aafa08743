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

/// Corners of any scene matched between simultaneous images of a left and a right camera. Nothing
/// is known of where they are in space.
struct PairObservations {
  std::vector<ImagePair> image_pairs;      ///< of distinct numbers, in the order of their rows
  std::vector<Eigen::Vector4d> pixels_px;  ///< u_left, v_left, u_right, v_right
  /// Standard deviation of a coordinate: one a row, or a single one for all. Empty: 1 px.
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

/// Adds all of `more` as image pairs of their own; one whose number is taken gets the least that is
/// free.
void append(PairObservations& pairs, const PairObservations& more);

/// The rows with `kept`, image pairs without any left out.
PairObservations selected(const PairObservations& pairs, const std::vector<bool>& kept);

/// Checks that the rig can be calibrated from the pairs: two cameras, pixels finite and inside the
/// images, noise above 0 and finite, no match given twice. Throws Error naming the row as a line of
/// the file `place` (rows begin on its second line), or by its number where `place` is empty.
void check_pairs(const PairObservations& pairs, const Rig& rig, const std::string& place = "");

}  // namespace vernier
