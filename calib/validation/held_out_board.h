// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "calib/board_observations.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/frame_rows.h"
#include "calib/rig_estimate.h"
#include "calib/triangulation.h"
#include "calib/validation/board_lengths.h"

namespace vernier::internal {

/// A length, or a mean of several, with its derivatives with respect to the rig and the pixels of
/// corners (both cameras).
struct MeasuredValue {
  double value = 0, truth = 0;
  Eigen::RowVectorXd by_rig;
  std::map<int, Eigen::RowVector4d> by_pixels;  ///< by corner
};

/// A board that a calibration did not see, triangulated with its rig.
class HeldOutBoard {
 public:
  HeldOutBoard(const BoardObservations& observations,
               int frame,
               const SeenPair& seen,
               const RigEstimate& estimate);

  /// Corners that could be triangulated.
  int corners() const { return static_cast<int>(points_.size()); }
  /// Rows, columns and diagonals of these corners, end to end.
  const std::vector<MeasuredValue>& lengths() const { return lengths_; }
  /// The mean of the lengths over their true values; the truth is 1.
  MeasuredValue scale() const;

  /// The derivatives of the corners in this frame, at the pose that fits them best.
  FrameRows rows(const RigEstimate& estimate) const;
  const std::vector<Eigen::Vector3d>& target_m() const { return observations_.target_m; }

 private:
  const BoardObservations& observations_;
  int frame_;
  std::map<int, PointTriangulation> points_;
  std::vector<MeasuredValue> lengths_;
};

/// The variances that are stated for a value of one board (calib/validation/held_out_boards.h).
struct StatedVariances {
  double honest = 0, mvb = 0;
  double components = 0;  ///< by the honest covariance and the components of the corner noise
};

class BoardVariances {
 public:
  /// Throws Error if no pose fits the board.
  BoardVariances(const RigEstimate& estimate, const HeldOutBoard& board, const CornerNoise& noise);

  StatedVariances of(const MeasuredValue& measured) const;

 private:
  const RigEstimate& estimate_;
  FrameRows rows_;
  Eigen::MatrixXd corners_px2_;  ///< V_f
};

}  // namespace vernier::internal
