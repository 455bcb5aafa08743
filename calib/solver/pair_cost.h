// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/cost_function.h>
#include <ceres/evaluation_callback.h>

#include <memory>
#include <vector>

#include "calib/board_state.h"
#include "calib/pair_observations.h"
#include "calib/solver/packed_pairs.h"
#include "calib/solver/parameter_buffer.h"

namespace vernier::internal {

/// The Sampson residuals of matched pairs for Ceres: one block with as many rows as a pair's row
/// has columns. As with CompressedViews (calib/solver/view_cost.h), a triangular factor of [J r]ᵀ
/// [J r] replaces all rows with the same cost, gradient and Gauss–Newton matrix. One block for all
/// image pairs: those with few pairs leave more directions undetermined than a factor can represent
/// given rounding.
class CompressedPairs : public ceres::EvaluationCallback {
 public:
  /// Residuals are in standard deviations times `unit`; `weights` multiply their squares, one per
  /// row, or none. Refers to `parameters`, which Ceres changes, during its lifetime.
  CompressedPairs(const PairObservations& pairs,
                  const std::vector<double>& weights,
                  double unit,
                  const BoardState& start,
                  const ParameterBuffer& parameters);

  void PrepareForEvaluation(bool jacobians, bool new_point) override;

  /// Its parameter blocks are the intrinsics of both cameras and the second camera's pose.
  std::unique_ptr<ceres::CostFunction> cost() const;

 private:
  friend class PairCost;

  PackedPairs packed_;
  double unit_;
  const ParameterBuffer& parameters_;
  BoardState state_;
  int columns_;
  bool with_jacobians_ = false;
  Eigen::Matrix3d rotation_by_block_ = Eigen::Matrix3d::Identity();
  std::vector<double> sums_;  // the triangle U; evaluated without, χ² in the first
};

}  // namespace vernier::internal
