// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/pair_cost.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/pair_observations.h"
#include "calib/pose.h"
#include "calib/solver/epipolar_kernel.h"
#include "calib/solver/packed_pairs.h"
#include "calib/solver/parameter_buffer.h"
#include "calib/solver/view_kernel.h"

namespace vernier::internal {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The upper triangular U with UᵀU = sums, in place, packed. A column that depends on those before
/// it up to rounding gets a row of zeros; the last column keeps its length regardless of rounding.
void factor_triangle(int n, double* sums) {
  const double squares = sums[packed_index(n - 1, n - 1, n)];
  const auto at = [&](int i, int j) -> double& { return sums[packed_index(i, j, n)]; };
  for (int i = 0; i < n; ++i) {
    const double full = at(i, i);
    double pivot = full;
    for (int k = 0; k < i; ++k) pivot -= at(k, i) * at(k, i);
    const double inverse = pivot > full * n * 0x1p-52 ? 1 / std::sqrt(pivot) : 0;
    for (int j = i; j < n; ++j) {
      double sum = at(i, j);
      for (int k = 0; k < i; ++k) sum -= at(k, i) * at(k, j);
      at(i, j) = sum * inverse;
    }
  }
  double kept = 0;
  for (int k = 0; k < n; ++k) kept += at(k, n - 1) * at(k, n - 1);
  const double shorter = kept > 0 ? std::sqrt(squares / kept) : 1;
  for (int k = 0; k < n; ++k) at(k, n - 1) *= shorter;
}

}  // namespace

/// The rows prepared by CompressedPairs.
class PairCost : public ceres::CostFunction {
 public:
  explicit PairCost(const CompressedPairs& all) : all_(all) {
    set_num_residuals(all.columns_);
    for (const Camera& camera : all.state_.rig.cameras) {
      mutable_parameter_block_sizes()->push_back(static_cast<int>(camera.parameters.size()));
    }
    mutable_parameter_block_sizes()->push_back(6);
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    const int m = all_.columns_;
    const double* sums = all_.sums_.data();
    Eigen::Map<Eigen::VectorXd> r(residuals, m);
    if (!all_.with_jacobians_) {
      r.setZero();
      r[0] = std::sqrt(sums[0]);
      return std::isfinite(r[0]);
    }
    Eigen::MatrixXd U = Eigen::MatrixXd::Zero(m, m);
    for (int i = 0; i < m; ++i) {
      for (int j = i; j < m; ++j, ++sums) U(i, j) = *sums;
    }
    if (!U.allFinite()) return false;
    r = U.col(m - 1);
    if (!jacobians) return true;
    Eigen::Index column = 0;
    for (std::size_t b = 0; b < parameter_block_sizes().size(); ++b) {
      const int size = parameter_block_sizes()[b];
      if (jacobians[b]) {
        Eigen::Map<RowMajor> J(jacobians[b], m, size);
        J = U.middleCols(column, size);
        if (b == 2) J.leftCols<3>() = (U.middleCols<3>(column) * all_.rotation_by_block_).eval();
      }
      column += size;
    }
    return true;
  }

 private:
  const CompressedPairs& all_;
};

CompressedPairs::CompressedPairs(const PairObservations& pairs,
                                 const std::vector<double>& weights,
                                 double unit,
                                 const BoardState& start,
                                 const ParameterBuffer& parameters)
    : packed_(pairs, weights),
      unit_(unit),
      parameters_(parameters),
      state_(start),
      columns_(epipolar_columns(EpipolarView(start.rig))),
      sums_(packed_size(columns_)) {}

std::unique_ptr<ceres::CostFunction> CompressedPairs::cost() const {
  return std::make_unique<PairCost>(*this);
}

void CompressedPairs::PrepareForEvaluation(bool jacobians, bool new_point) {
  if (!new_point && (with_jacobians_ || !jacobians)) return;
  parameters_.write_to(state_);
  with_jacobians_ = jacobians;
  const EpipolarView view(state_.rig);
  std::fill(sums_.begin(), sums_.end(), 0.0);
  std::vector<double> residuals;
  for (const PackedPairs::Group& group : packed_.groups()) {
    if (jacobians) {
      sum_pairs(view, packed_.lanes(group), group.eights, {}, sums_.data());
      continue;
    }
    residuals.resize(group.eights * kernel_lanes);
    pair_residuals(view, packed_.lanes(group), group.eights, residuals.data());
    for (const double r : residuals) sums_[0] += r * r;
  }
  for (double& sum : sums_) sum *= unit_ * unit_;
  if (jacobians) factor_triangle(columns_, sums_.data());
  if (!jacobians) return;
  const double* pose = parameters_.camera_pose(1);
  rotation_by_block_ = left_jacobian({pose[0], pose[1], pose[2]});
}

}  // namespace vernier::internal
