// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/solver/refined_minimum.h"

namespace vernier::internal {

/// Difference between our propagated covariances and mrcal's, over a grid of pixels of every camera
/// at several distances and at infinity, and over points seen by the first camera and each other:
/// max |C_ij − C_mrcal,ij| / √(C_mrcal,ii C_mrcal,jj).
struct UncertaintyComparison {
  std::string absent;  ///< why nothing was compared; empty if it was
  double max_projection_covariance_diff = 0;
  std::string worst_projection;                  ///< such as "left, 5 m, pixel (32, 24)"
  int projections = 0;                           ///< number of covariances
  double max_triangulation_covariance_diff = 0;  ///< contribution of the calibration, both frames
  double max_observation_covariance_diff = 0;    ///< the pair's own noise
  int triangulations = 0;                        ///< 0 with one camera
};

/// Compares mrcal (calib/mrcal/mrcal_uncertainty.h) with calib/projection_uncertainty.h and
/// calib/triangulation_uncertainty.h. Throws Error if mrcal fails.
UncertaintyComparison compare_uncertainty(const std::filesystem::path& script,
                                          const BoardObservations& observations,
                                          const RefinedMinimum& ours,
                                          double pixel_sigma_px,
                                          const std::vector<bool>& held = {});

}  // namespace vernier::internal
