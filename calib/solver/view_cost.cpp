// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/view_cost.h"

#include <cmath>
#include <cstddef>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/solver/frame_kernel.h"
#include "calib/solver/packed_views.h"
#include "calib/solver/parameter_buffer.h"
#include "calib/solver/reprojection_problem.h"
#include "calib/solver/view_kernel.h"

namespace vernier::internal {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

ReprojectionProblem in_pixels(ReprojectionProblem problem) {
  problem.pixel_sigma_px = 1;
  return problem;
}

/// The twist (w, v) of a pose by its block (rotation vector, translation): w = J_l dr and
/// v = dt + t x w.
Eigen::Matrix<double, 6, 6> twist_by_block(const double* block) {
  Eigen::Matrix<double, 6, 6> T = Eigen::Matrix<double, 6, 6>::Identity();
  T.topLeftCorner<3, 3>() = left_jacobian({block[0], block[1], block[2]});
  T.bottomLeftCorner<3, 3>() = hat({block[3], block[4], block[5]}) * T.topLeftCorner<3, 3>();
  return T;
}

}  // namespace

/// One view's rows prepared by CompressedViews.
class ViewCost : public ceres::CostFunction {
 public:
  ViewCost(const CompressedViews& all, const CompressedViews::Place& place)
      : all_(all), place_(place) {
    const Camera& camera = all.state_.rig.cameras[place.camera];
    set_num_residuals(place.columns);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(camera.parameters.size()));
    mutable_parameter_block_sizes()->push_back(6);
    if (place.camera > 0) mutable_parameter_block_sizes()->push_back(6);
    if (all.views_.warp()) mutable_parameter_block_sizes()->push_back(2);
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    const int m = place_.columns;
    Eigen::Map<Eigen::VectorXd> r(residuals, m);
    const Lanes* sums = &all_.sums_[place_.sums];
    if (!all_.with_jacobians_) {
      r.setZero();
      r[0] = std::sqrt(sums[0].of[place_.lane]);
      return std::isfinite(r[0]);
    }
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 24, 24> U(m, m);
    U.setZero();
    for (int i = 0; i < m; ++i) {
      for (int j = i; j < m; ++j, ++sums) U(i, j) = sums->of[place_.lane];
    }
    r = U.col(m - 1);
    if (jacobians) write(U, jacobians);
    return U.allFinite();
  }

 private:
  template <class Matrix>
  void write(const Matrix& U, double** jacobians) const {
    const int m = place_.columns;
    const Camera& camera = all_.state_.rig.cameras[place_.camera];
    const auto n = static_cast<int>(camera.parameters.size());
    const auto block = [&](int index, int columns) {
      return Eigen::Map<RowMajor>(jacobians[index], m, columns);
    };
    if (jacobians[0]) {  // fx = f ax, fy = f
      auto J = block(0, n);
      J = U.leftCols(n);
      J.col(0) = camera.ax() * U.col(0) + U.col(1);
      J.col(1) = camera.f_px() * U.col(0);
    }
    const auto by_twist = U.template middleCols<6>(n);
    if (jacobians[1]) {
      block(1, 6).noalias() = by_twist.lazyProduct(all_.board_twist(place_));
    }
    if (place_.camera > 0 && jacobians[2]) {
      block(2, 6).noalias() = by_twist.lazyProduct(all_.camera_by_block_[place_.camera]);
    }
    const int warp = place_.camera > 0 ? 3 : 2;
    if (all_.views_.warp() && jacobians[warp]) block(warp, 2) = U.template middleCols<2>(n + 6);
  }

  const CompressedViews& all_;
  const CompressedViews::Place& place_;
};

CompressedViews::CompressedViews(const BoardObservations& observations,
                                 const BoardState& start,
                                 const ReprojectionProblem& problem,
                                 const ParameterBuffer& parameters)
    : views_(observations, start, in_pixels(problem)),
      parameters_(parameters),
      state_(start),
      pixels_(views_.pack(views_.observed_px(observations))),
      places_(observations.views.size()),
      board_by_block_(start.frames.size()),
      camera_by_block_(start.rig.cameras.size()) {
  std::size_t size = 0;
  for (const FrameGroup& group : views_.groups()) {
    auto& first = first_.emplace_back();
    for (std::size_t c = 0; c < group.cameras.size(); ++c) {
      first.push_back(size);
      if (group.cameras[c].corners == 0) continue;
      const int columns = view_columns(start.rig.cameras[c].model, views_.warp());
      for (int l = 0; l < kernel_lanes; ++l) {
        const int view = group.cameras[c].views[l];
        if (view < 0) continue;
        places_[view] = {size, l, static_cast<int>(c), group.frames[l], columns};
      }
      size += packed_size(columns);
    }
  }
  sums_.resize(size);
}

std::unique_ptr<ceres::CostFunction> CompressedViews::cost(std::size_t view) const {
  return std::make_unique<ViewCost>(*this, places_[view]);
}

CompressedViews::Matrix6 CompressedViews::board_twist(const Place& place) const {
  if (place.camera == 0) return board_by_block_[place.frame];
  const Pose& T = state_.rig.T_camera_first[place.camera];
  Matrix6 adjoint = Matrix6::Zero();
  adjoint.topLeftCorner<3, 3>() = T.R;
  adjoint.bottomRightCorner<3, 3>() = T.R;
  adjoint.bottomLeftCorner<3, 3>() = hat(T.t) * T.R;
  return adjoint.lazyProduct(board_by_block_[place.frame]);
}

void CompressedViews::evaluate_group(std::size_t group, bool jacobians) {
  const FrameGroup& frames = views_.groups()[group];
  for (std::size_t c = 0; c < frames.cameras.size(); ++c) {
    if (frames.cameras[c].corners == 0) continue;
    const Camera& camera = state_.rig.cameras[c];
    const Eigen::VectorXd intrinsics = kernel_intrinsics(camera);
    Lanes poses[12];
    camera_poses(state_, static_cast<int>(c), frames, poses);
    const ViewLanes lanes =
        views_.lanes(frames, static_cast<int>(c), state_, intrinsics.data(), poses[0].of, pixels_);
    double* sums = sums_[first_[group][c]].of;
    if (jacobians) {
      sum_views(lanes, sums);
      factor_views(view_columns(camera.model, views_.warp()), sums);
    } else {
      sum_residuals(lanes, sums);
    }
  }
}

void CompressedViews::PrepareForEvaluation(bool jacobians, bool new_point) {
  if (!new_point && (with_jacobians_ || !jacobians)) return;
  parameters_.write_to(state_);
  with_jacobians_ = jacobians;
  for (std::size_t g = 0; g < views_.groups().size(); ++g) evaluate_group(g, jacobians);
  if (!jacobians) return;
  for (std::size_t f = 0; f < board_by_block_.size(); ++f) {
    board_by_block_[f] = twist_by_block(parameters_.board(f));
  }
  for (std::size_t c = 1; c < camera_by_block_.size(); ++c) {
    camera_by_block_[c] = twist_by_block(parameters_.camera_pose(static_cast<int>(c)));
  }
}

}  // namespace vernier::internal
