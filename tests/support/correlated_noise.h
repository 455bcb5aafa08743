// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/board_observations.h"
#include "calib/statistics/random.h"

namespace vernier::test {

using namespace vernier::internal;

/// Adds to every view of a 9 x 6 board an error that is smooth over the board, as an unflat board,
/// blur or a wrong lens model make it: a random quadratic of standard deviation near `sigma_px`,
/// drawn anew for each view, camera and coordinate.
inline void add_smooth_error(BoardObservations& observations,
                             double sigma_px,
                             std::uint64_t seed,
                             std::uint32_t trial) {
  for (BoardView& view : observations.views) {
    RandomStream draws({.seed = seed,
                        .trial = trial,
                        .feature = static_cast<std::uint32_t>(view.frame * 4 + view.camera)});
    const Eigen::VectorXd u = draws.normals(6), v = draws.normals(6);
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      const double x = (view.ids[i] % 9 - 4) / 4.0, y = (view.ids[i] / 9 - 2.5) / 2.5;
      Eigen::VectorXd basis(6);
      basis << 0.6, x, y, x * x, x * y, y * y;
      view.pixels_px[i].x() += 0.5 * sigma_px * u.dot(basis);
      view.pixels_px[i].y() += 0.5 * sigma_px * v.dot(basis);
    }
  }
}

}  // namespace vernier::test
