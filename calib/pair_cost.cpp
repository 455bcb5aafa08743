// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/pair_cost.h"

#include <cmath>

namespace vernier {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The upper triangular U with UᵀU = sums, in place, packed. A column that depends on those before
/// it to rounding gets a row of zeros.
void factor_triangle(int n, double* sums) {
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
}

}  // namespace

/// One image pair's rows of what CompressedPairs prepared.
class PairCost : public ceres::CostFunction {
 public:
  PairCost(const CompressedPairs& all, std::size_t group) : all_(all), group_(group) {
    set_num_residuals(all.columns_);
    for (const Camera& camera : all.state_.rig.cameras) {
      mutable_parameter_block_sizes()->push_back(static_cast<int>(camera.parameters.size()));
    }
    mutable_parameter_block_sizes()->push_back(6);
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    const int m = all_.columns_;
    const double* sums = all_.sums_.data() + group_ * packed_size(m);
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
  std::size_t group_;
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
      sums_(packed_.groups().size() * packed_size(columns_)) {}

std::unique_ptr<ceres::CostFunction> CompressedPairs::cost(std::size_t image_pair) const {
  return std::make_unique<PairCost>(*this, image_pair);
}

void CompressedPairs::PrepareForEvaluation(bool jacobians, bool new_point) {
  if (!new_point && (with_jacobians_ || !jacobians)) return;
  parameters_.write_to(state_);
  with_jacobians_ = jacobians;
  const EpipolarView view(state_.rig);
  std::vector<double> residuals;
  for (std::size_t g = 0; g < packed_.groups().size(); ++g) {
    const PackedPairs::Group& group = packed_.groups()[g];
    double* const sums = sums_.data() + g * packed_size(columns_);
    if (!jacobians) {
      residuals.resize(group.eights * kernel_lanes);
      pair_residuals(view, packed_.lanes(group), group.eights, residuals.data());
      double chi2 = 0;
      for (const double r : residuals) chi2 += r * r;
      sums[0] = unit_ * unit_ * chi2;
      continue;
    }
    std::fill_n(sums, packed_size(columns_), 0.0);
    sum_pairs(view, packed_.lanes(group), group.eights, {}, sums);
    for (std::size_t i = 0; i < packed_size(columns_); ++i) sums[i] *= unit_ * unit_;
    factor_triangle(columns_, sums);
  }
  if (!jacobians) return;
  const double* pose = parameters_.camera_pose(1);
  rotation_by_block_ = left_jacobian({pose[0], pose[1], pose[2]});
}

}  // namespace vernier
