// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/triangulation.h"

namespace vernier::internal {

/// Points (of the camera's frame, metres; directions at infinity) whose pixel's covariance is asked
/// for.
struct MrcalProjectionQuery {
  int camera = 0;
  bool at_infinity = false;
  std::vector<Eigen::Vector3d> points;
};

/// Pixel pairs of the first camera and another whose point's covariance is asked for.
struct MrcalTriangulationQuery {
  int other = 1;
  bool stabilised = false;
  std::vector<PixelPair> pairs;
};

struct MrcalTriangulationAnswer {
  std::vector<Eigen::Vector3d> points_m;
  std::vector<Eigen::Matrix3d> calibration, observation;
};

/// One answer a query, in their order.
struct MrcalUncertaintyAnswer {
  std::string absent;  ///< why there is no answer: no script, no Python, or one without mrcal
  std::string version;
  std::vector<std::vector<Eigen::Matrix2d>> projection;
  std::vector<MrcalTriangulationAnswer> triangulation;
};

/// A solved calibration and what is asked of it.
struct MrcalUncertaintyProblem {
  const BoardObservations& observations;
  const BoardState& state;    ///< the minimum
  double pixel_sigma_px = 1;  ///< of the calibration's corners and of the pairs alike
  /// A basis of the free directions among mrcal's states of the rig (such as MrcalLift::L); without
  /// one all of them are free and mrcal factors its own matrix.
  std::optional<Eigen::MatrixXd> basis;
  std::vector<MrcalProjectionQuery> projection;
  std::vector<MrcalTriangulationQuery> triangulation;
};

/// Asks mrcal's projection_uncertainty and triangulate by the script `python/mrcal_uncertainty.py`,
/// run by /usr/bin/python3 (whose packages are Debian's), else by the first python3 of the path.
/// The script is named by its absolute path. What mrcal has no number for is NaN. Throws Error
/// where mrcal cannot express the problem or fails at it.
MrcalUncertaintyAnswer run_mrcal_uncertainty(const std::filesystem::path& script,
                                             const MrcalUncertaintyProblem& problem);

/// What version of mrcal a Python here has; empty where none has it.
std::string mrcal_python_version(const std::filesystem::path& script);

}  // namespace vernier::internal
