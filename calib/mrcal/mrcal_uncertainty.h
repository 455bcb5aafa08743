// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/triangulation.h"

namespace vernier::internal {

/// Points (in the camera's frame, metres; directions at infinity) whose projection covariance is
/// requested.
struct MrcalProjectionQuery {
  int camera = 0;
  bool at_infinity = false;
  std::vector<Eigen::Vector3d> points;
};

/// Pixel pairs of the first camera and another whose triangulation covariance is requested.
struct MrcalTriangulationQuery {
  int other = 1;
  bool stabilised = false;
  std::vector<PixelPair> pairs;
};

struct MrcalTriangulationAnswer {
  std::vector<Eigen::Vector3d> points_m;
  std::vector<Eigen::Matrix3d> calibration, observation;
};

/// One answer per query, in order.
struct MrcalUncertaintyAnswer {
  std::string absent;  ///< why there is no answer: no script, no Python, or one without mrcal
  std::string version;
  std::vector<std::vector<Eigen::Matrix2d>> projection;
  std::vector<MrcalTriangulationAnswer> triangulation;
};

/// A solved calibration with the queries about it.
struct MrcalUncertaintyProblem {
  const BoardObservations& observations;
  const BoardState& state;    ///< the minimum
  double pixel_sigma_px = 1;  ///< of the calibration's corners and of the pairs alike
  /// A basis of the free directions in mrcal's states of the rig (such as MrcalLift::L); without
  /// one all of them are free and mrcal factors its own matrix.
  std::optional<Eigen::MatrixXd> basis;
  std::vector<MrcalProjectionQuery> projection;
  std::vector<MrcalTriangulationQuery> triangulation;
};

/// Runs mrcal's projection_uncertainty and triangulate in the script `python/mrcal_uncertainty.py`,
/// with /usr/bin/python3 (which has Debian's packages), else with the first python3 in PATH. The
/// script is given by its absolute path. Values that mrcal cannot compute are NaN. Throws Error if
/// mrcal cannot express the problem or fails.
MrcalUncertaintyAnswer run_mrcal_uncertainty(const std::filesystem::path& script,
                                             const MrcalUncertaintyProblem& problem);

/// Reads the script's answer. Throws Error if it is none, or not of the problem's queries.
MrcalUncertaintyAnswer parse_mrcal_answer(std::string_view text,
                                          const MrcalUncertaintyProblem& problem);

/// The version of mrcal in an available Python; empty if none has it.
std::string mrcal_python_version(const std::filesystem::path& script);

}  // namespace vernier::internal
