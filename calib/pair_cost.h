// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/cost_function.h>
#include <ceres/evaluation_callback.h>

#include <memory>
#include <vector>

#include "calib/packed_pairs.h"
#include "calib/parameter_buffer.h"

namespace vernier {

/// The Sampson residuals of matched pairs as Ceres gets them: one block an image pair, of as many
/// rows as a pair's row has columns. As with CompressedViews (calib/view_cost.h), a triangular
/// factor of [J r]ᵀ [J r] stands for all rows of an image pair with the same cost, gradient and
/// Gauss–Newton matrix.
class CompressedPairs : public ceres::EvaluationCallback {
 public:
  /// Residuals are in standard deviations times `unit`; `weights` multiply their squares, one a
  /// row, or none. Refers to `parameters`, which Ceres changes, as long as it lives.
  CompressedPairs(const PairObservations& pairs,
                  const std::vector<double>& weights,
                  double unit,
                  const BoardState& start,
                  const ParameterBuffer& parameters);

  void PrepareForEvaluation(bool jacobians, bool new_point) override;

  std::size_t image_pairs() const { return packed_.groups().size(); }

  /// The block of an image pair. Its parameter blocks are the intrinsics of both cameras and the
  /// second one's pose.
  std::unique_ptr<ceres::CostFunction> cost(std::size_t image_pair) const;

 private:
  friend class PairCost;

  PackedPairs packed_;
  double unit_;
  const ParameterBuffer& parameters_;
  BoardState state_;
  int columns_;
  bool with_jacobians_ = false;
  Eigen::Matrix3d rotation_by_block_ = Eigen::Matrix3d::Identity();
  std::vector<double> sums_;  // triangles of U; of an image pair evaluated without, χ² in the first
};

}  // namespace vernier
