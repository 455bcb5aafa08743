// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/rig_estimate.h"

namespace vernier::internal {

/// One corner of a calibration with its residual.
struct CornerResidual {
  int frame = 0, id = 0;
  Eigen::Vector2d pixel_px{0, 0};
  Eigen::Vector2d residual_px{0, 0};  ///< prediction minus pixel
};

/// For one camera, in the order of the evidence. Throws Error if there is none.
std::vector<CornerResidual> residuals_of_camera(const RigEstimate& estimate, int camera);

/// A rectangle of an image with the mean residual of the corners in it.
struct ResidualCell {
  int corners = 0;
  Eigen::Vector2d mean_px{0, 0};
  double in_sigmas = 0;  ///< |mean| √corners / σ
};

/// Residuals of one camera as noise and structure. For independent normal noise of standard
/// deviation σ, corners · |mean|² / σ² of a cell is χ² with two degrees of freedom, so that a
/// fraction exp(−x²/2) of the cells has in_sigmas > x: 5 % beyond 2.448. More indicate errors of
/// the camera model. (Fitting reduces the residuals a little: the fractions err on the safe side by
/// the number of parameters relative to that of coordinates.)
struct ResidualStructure {
  int columns = 0, rows = 0;
  std::vector<ResidualCell> cells;  ///< row by row, over the image
  int filled = 0;                   ///< cells with corners
  int beyond_95 = 0;                ///< of them, with in_sigmas > 2.448
  std::vector<int> histogram;       ///< of residual / σ, coordinates; the outermost bins are open
  double first_edge = 0, bin = 0;   ///< bin k spans [first_edge + k bin, first_edge + (k+1) bin)
  double beyond_3_sigma = 0;        ///< fraction of coordinates; 0.0027 for a normal error
};

/// Throws Error unless columns, rows and σ are above 0.
ResidualStructure residual_structure(const std::vector<CornerResidual>& residuals,
                                     const Eigen::Vector2i& size_px,
                                     double pixel_sigma_px,
                                     int columns,
                                     int rows);

}  // namespace vernier::internal
