// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/ceres.h>

#include <memory>

#include "calib/board/view_linearisation.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/pose.h"
#include "calib/solver/parameter_buffer.h"

namespace vernier {

using namespace vernier::internal;

/// A calibration as usually written for Ceres, one analytic block with all residuals of a view, for
/// ceres::Covariance.
class PlainProblem {
 public:
  PlainProblem(const BoardObservations& observations, const BoardState& state)
      : state_(state), buffer_(state_) {
    std::size_t frame = 0;
    for (const BoardView& view : observations.views) {
      while (state_.frames[frame] != view.frame) ++frame;
      std::vector<double*> blocks{buffer_.intrinsics(view.camera), buffer_.board(frame)};
      if (view.camera > 0) blocks.push_back(buffer_.camera_pose(view.camera));
      problem_.AddResidualBlock(new Cost(observations, view, state_.rig.cameras[view.camera]),
                                nullptr, blocks);
    }
  }

  /// Variance of the first camera's focal length, from the covariance of all pairs of the rig's
  /// blocks by sparse QR (SuiteSparse).
  double rig_covariance() {
    std::vector<double*> blocks;
    for (int c = 0; c < static_cast<int>(state_.rig.cameras.size()); ++c) {
      blocks.push_back(buffer_.intrinsics(c));
      if (c > 0) blocks.push_back(buffer_.camera_pose(c));
    }
    std::vector<std::pair<const double*, const double*>> pairs;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      for (std::size_t j = i; j < blocks.size(); ++j) pairs.emplace_back(blocks[i], blocks[j]);
    }
    ceres::Covariance::Options options;
    options.algorithm_type = ceres::SPARSE_QR;
    options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
    options.num_threads = 1;
    ceres::Covariance covariance(options);
    if (!covariance.Compute(pairs, &problem_)) return 0;
    Eigen::MatrixXd C(8, 8);
    covariance.GetCovarianceBlock(blocks[0], blocks[0], C.data());
    return C(0, 0);
  }

 private:
  class Cost : public ceres::CostFunction {
   public:
    Cost(const BoardObservations& observations, const BoardView& view, const Camera& camera)
        : observations_(observations), view_(view), camera_(camera) {
      set_num_residuals(2 * static_cast<int>(view.ids.size()));
      mutable_parameter_block_sizes()->push_back(static_cast<int>(camera.parameters.size()));
      mutable_parameter_block_sizes()->push_back(6);
      if (view.camera > 0) mutable_parameter_block_sizes()->push_back(6);
    }

    bool Evaluate(double const* const* blocks, double* residuals, double** J) const override {
      using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      Camera camera = camera_;
      camera.parameters = Eigen::Map<const Eigen::VectorXd>(blocks[0], camera_.parameters.size());
      const Pose T_camera_first = view_.camera > 0 ? read_block(blocks[2]) : Pose{};
      ViewLinearisation at;
      linearise_view(camera, T_camera_first, read_block(blocks[1]), observations_.target_m, view_,
                     Linearise::with_jacobian, at);
      const auto rows = num_residuals();
      Eigen::Map<Eigen::VectorXd>(residuals, rows) = at.residual_px;
      const auto pose = [&](const auto& by_tangent, int b) {
        Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>> out(J[b], rows, 6);
        out.template leftCols<3>() = by_tangent.template leftCols<3>() *
                                     left_jacobian({blocks[b][0], blocks[b][1], blocks[b][2]});
        out.template rightCols<3>() = by_tangent.template rightCols<3>();
      };
      if (J && J[0]) Eigen::Map<RowMajor>(J[0], rows, at.by_camera.cols()) = at.by_camera;
      if (J && J[1]) pose(at.by_board_pose, 1);
      if (J && view_.camera > 0 && J[2]) pose(at.by_camera_pose, 2);
      return true;
    }

   private:
    const BoardObservations& observations_;
    const BoardView& view_;
    const Camera& camera_;
  };

  BoardState state_;
  ParameterBuffer buffer_;
  ceres::Problem problem_;
};

}  // namespace vernier
