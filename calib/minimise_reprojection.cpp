// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/minimise_reprojection.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "calib/board_warp.h"
#include "calib/error.h"
#include "calib/view_linearisation.h"

namespace vernier {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A pose as Ceres sees it: rotation vector (radians) and translation (metres). Its derivative is
/// the left tangent's times J_l, which keeps Ceres' own manifolds and their half angles out.
void write_block(const Pose& pose, double* block) {
  Eigen::Map<Eigen::Vector3d>{block} = vector_from_rotation(pose.R);
  Eigen::Map<Eigen::Vector3d>(block + 3) = pose.t;
}

Pose read_block(const double* b) {
  return {rotation_from_vector({b[0], b[1], b[2]}), {b[3], b[4], b[5]}};
}

/// All parameters in one piece of memory. Ceres orders blocks by their addresses, so separate
/// allocations would let the order of its sums, and with it the last bits, change from run to run.
class ParameterBuffer {
 public:
  explicit ParameterBuffer(const BoardState& state)
      : rig_(state.rig), intrinsics_(pose_index(rig_, 1)), cameras_(rig_.cameras.size()) {
    values_.resize(intrinsics_ + 6 * (cameras_ + state.frames.size()) + 2);
    for (std::size_t c = 0; c < cameras_; ++c) {
      const Eigen::VectorXd& a = rig_.cameras[c].parameters;
      std::copy(a.begin(), a.end(), intrinsics(static_cast<int>(c)));
      write_block(rig_.T_camera_first[c], camera_pose(static_cast<int>(c)));
    }
    for (std::size_t f = 0; f < state.frames.size(); ++f) {
      write_block(state.T_first_board[f], board(f));
    }
    std::copy(state.warp_m.begin(), state.warp_m.end(), warp());
  }

  double* intrinsics(int camera) { return values_.data() + intrinsics_index(rig_, camera); }
  double* camera_pose(int camera) { return values_.data() + intrinsics_ + 6 * camera; }
  double* warp() { return values_.data() + intrinsics_ + 6 * cameras_; }
  double* board(std::size_t frame) {
    return values_.data() + intrinsics_ + 6 * (cameras_ + frame) + 2;
  }

  void write_to(BoardState& state) {
    for (std::size_t c = 0; c < cameras_; ++c) {
      Eigen::VectorXd& a = state.rig.cameras[c].parameters;
      a = Eigen::Map<Eigen::VectorXd>(intrinsics(static_cast<int>(c)), a.size());
      if (c > 0) state.rig.T_camera_first[c] = read_block(camera_pose(static_cast<int>(c)));
    }
    for (std::size_t f = 0; f < state.frames.size(); ++f) {
      state.T_first_board[f] = read_block(board(f));
    }
    state.warp_m = Eigen::Map<Eigen::Vector2d>(warp());
  }

 private:
  Rig rig_;
  std::size_t intrinsics_, cameras_;
  std::vector<double> values_;
};

/// The board as the cost sees it: its warp is known, or a block of unknowns.
struct Board {
  std::vector<Eigen::Vector3d> target_m;  // with the warp where that is known, else flat
  Eigen::Matrix<double, Eigen::Dynamic, 2> shapes;
  bool warps = false;
};

/// Residuals of one view: blocks are the intrinsics, the board's pose, for every camera but the
/// first the camera's pose, and the board's warp where it is free.
class ViewCost : public ceres::CostFunction {
 public:
  ViewCost(const Board& board,
           const BoardView& view,
           const Camera& camera,
           const std::vector<double>* weights)
      : board_(board), view_(view), camera_(camera), weights_(weights) {
    set_num_residuals(2 * static_cast<int>(view.ids.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(camera.parameters.size()));
    mutable_parameter_block_sizes()->push_back(6);
    if (view.camera > 0) mutable_parameter_block_sizes()->push_back(6);
    if (board.warps) mutable_parameter_block_sizes()->push_back(2);
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    Camera camera = camera_;
    camera.parameters = Eigen::Map<const Eigen::VectorXd>(blocks[0], camera_.parameters.size());
    const Pose T_first_board = read_block(blocks[1]);
    const Pose T_camera_first = view_.camera > 0 ? read_block(blocks[2]) : Pose{};
    const int warp = view_.camera > 0 ? 3 : 2;
    ViewLinearisation J;
    linearise_view(camera, T_camera_first, T_first_board, target(blocks, warp), view_,
                   jacobians ? Linearise::with_jacobian : Linearise::residual_only, J,
                   board_.warps ? &board_.shapes : nullptr);
    if (weights_) weigh(jacobians != nullptr, J);
    const auto rows = num_residuals();
    Eigen::Map<Eigen::VectorXd>(residuals, rows) = J.residual_px;
    if (!jacobians) return J.residual_px.allFinite();
    if (jacobians[0]) Eigen::Map<RowMajor>(jacobians[0], rows, J.by_camera.cols()) = J.by_camera;
    if (jacobians[1]) write_pose(J.by_board_pose, blocks[1], jacobians[1]);
    if (view_.camera > 0 && jacobians[2]) write_pose(J.by_camera_pose, blocks[2], jacobians[2]);
    if (board_.warps && jacobians[warp]) {
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>>(jacobians[warp], rows,
                                                                            2) = J.by_warp;
    }
    return J.residual_px.allFinite();
  }

 private:
  std::vector<Eigen::Vector3d> target(double const* const* blocks, int warp) const {
    if (!board_.warps) return board_.target_m;
    return warped_target(board_.target_m, {blocks[warp][0], blocks[warp][1]});
  }

  void weigh(bool derive, ViewLinearisation& J) const {
    for (std::size_t i = 0; i < weights_->size(); ++i) {
      const auto row = 2 * static_cast<Eigen::Index>(i);
      const double root = std::sqrt((*weights_)[i]);
      J.residual_px.segment<2>(row) *= root;
      if (!derive) continue;
      J.by_camera.middleRows<2>(row) *= root;
      J.by_board_pose.middleRows<2>(row) *= root;
      J.by_camera_pose.middleRows<2>(row) *= root;
      if (board_.warps) J.by_warp.middleRows<2>(row) *= root;
    }
  }

  static void write_pose(const Eigen::Matrix<double, Eigen::Dynamic, 6>& by_tangent,
                         const double* block,
                         double* out) {
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>> J(out, by_tangent.rows(),
                                                                            6);
    J.leftCols<3>() = by_tangent.leftCols<3>() * left_jacobian({block[0], block[1], block[2]});
    J.rightCols<3>() = by_tangent.rightCols<3>();
  }

  const Board& board_;
  const BoardView& view_;
  const Camera& camera_;
  const std::vector<double>* weights_;
};

/// A prior as residuals σ H δ with P = HᵀH: blocks are all intrinsics, then all camera poses but
/// the first.
class PriorCost : public ceres::CostFunction {
 public:
  PriorCost(const RigPrior& prior, double pixel_sigma_px) : prior_(prior) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(prior.information);
    half_ = pixel_sigma_px * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal() *
            eigen.eigenvectors().transpose();
    set_num_residuals(static_cast<int>(half_.rows()));
    for (const Camera& camera : prior.mean.cameras) {
      mutable_parameter_block_sizes()->push_back(static_cast<int>(camera.parameters.size()));
    }
    for (std::size_t c = 1; c < prior.mean.cameras.size(); ++c) {
      mutable_parameter_block_sizes()->push_back(6);
    }
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    Rig rig = prior_.mean;
    const std::size_t cameras = rig.cameras.size();
    for (std::size_t c = 0; c < cameras; ++c) {
      Eigen::VectorXd& a = rig.cameras[c].parameters;
      a = Eigen::Map<const Eigen::VectorXd>(blocks[c], a.size());
      if (c > 0) rig.T_camera_first[c] = read_block(blocks[cameras + c - 1]);
    }
    const PriorOffset offset = prior_offset(prior_, rig);
    const auto rows = num_residuals();
    Eigen::Map<Eigen::VectorXd>(residuals, rows) = half_ * offset.delta;
    if (!jacobians) return true;
    Eigen::MatrixXd J = half_ * offset.by_rig;
    for (std::size_t c = 1; c < cameras; ++c) {  // from the left tangent to the rotation vector
      const double* r = blocks[cameras + c - 1];
      const int i = pose_index(rig, static_cast<int>(c));
      J.middleCols<3>(i) = (J.middleCols<3>(i) * left_jacobian({r[0], r[1], r[2]})).eval();
    }
    Eigen::Index column = 0;
    for (std::size_t b = 0; b < parameter_block_sizes().size(); ++b) {
      const int size = parameter_block_sizes()[b];
      if (jacobians[b]) Eigen::Map<RowMajor>(jacobians[b], rows, size) = J.middleCols(column, size);
      column += size;
    }
    return true;
  }

 private:
  const RigPrior& prior_;
  Eigen::MatrixXd half_;
};

ceres::Solver::Options solver_options(int max_iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = max_iterations;
  options.function_tolerance = 1e-15;
  options.parameter_tolerance = 1e-13;
  options.gradient_tolerance = 1e-13;
  options.jacobi_scaling = true;
  // Columns are scaled to one: a damping that is never below 1e-12 keeps the Schur complement of a
  // model that the views hardly determine positive definite.
  options.max_trust_region_radius = 1e12;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;  // sums in one order: the same bits every time
  return options;
}

/// Builds the Ceres problem of one calibration and owns what its blocks refer to.
class Minimisation {
 public:
  Minimisation(const BoardObservations& observations,
               const BoardState& start,
               const ReprojectionProblem& what)
      : start_(start), what_(what), buffer_(start) {
    board_.warps = what.warp == BoardWarp::free;
    board_.target_m =
        board_.warps ? observations.target_m : warped_target(observations.target_m, start.warp_m);
    board_.shapes = warp_shapes(observations.target_m);
    add_views(observations);
    add_priors();
    hold();
  }

  BoardState solve() {
    ceres::Solver::Options options = solver_options(what_.max_iterations);
    options.linear_solver_ordering = ordering_;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    if (!summary.IsSolutionUsable() || summary.termination_type == ceres::NO_CONVERGENCE) {
      throw Error("calibration", "the minimisation did not converge: " + summary.message,
                  "look at the corners: a mirrored or turned board, or swapped cameras, do this");
    }
    BoardState state = start_;
    buffer_.write_to(state);
    return state;
  }

 private:
  void add_views(const BoardObservations& observations) {
    std::size_t frame = 0;
    for (std::size_t v = 0; v < observations.views.size(); ++v) {
      const BoardView& view = observations.views[v];
      while (start_.frames[frame] != view.frame) ++frame;
      std::vector<double*> blocks{buffer_.intrinsics(view.camera), buffer_.board(frame)};
      if (view.camera > 0) blocks.push_back(buffer_.camera_pose(view.camera));
      if (board_.warps) blocks.push_back(buffer_.warp());
      const auto* weights = what_.corner_weights.empty() ? nullptr : &what_.corner_weights[v];
      problem_.AddResidualBlock(
          new ViewCost(board_, view, start_.rig.cameras[view.camera], weights), nullptr, blocks);
      for (double* block : blocks) ordering_->AddElementToGroup(block, 1);
      ordering_->AddElementToGroup(blocks[1], 0);
    }
  }

  void add_priors() {
    std::vector<double*> blocks;
    const auto cameras = static_cast<int>(start_.rig.cameras.size());
    for (int c = 0; c < cameras; ++c) blocks.push_back(buffer_.intrinsics(c));
    for (int c = 1; c < cameras; ++c) blocks.push_back(buffer_.camera_pose(c));
    for (const RigPrior& prior : what_.priors) {
      problem_.AddResidualBlock(new PriorCost(prior, what_.pixel_sigma_px), nullptr, blocks);
    }
  }

  void hold() {
    if (what_.held.empty()) return;
    const auto cameras = static_cast<int>(start_.rig.cameras.size());
    for (int c = 0; c < cameras; ++c) {
      hold_block(buffer_.intrinsics(c), intrinsics_index(start_.rig, c),
                 static_cast<int>(start_.rig.cameras[c].parameters.size()));
      if (c > 0) hold_block(buffer_.camera_pose(c), pose_index(start_.rig, c), 6);
    }
  }

  void hold_block(double* block, int first, int size) {
    std::vector<int> held;
    for (int i = 0; i < size; ++i) {
      if (what_.held[first + i]) held.push_back(i);
    }
    if (held.empty()) return;
    if (static_cast<int>(held.size()) == size) {
      problem_.SetParameterBlockConstant(block);
    } else {
      problem_.SetManifold(block, new ceres::SubsetManifold(size, held));
    }
  }

  const BoardState& start_;
  const ReprojectionProblem& what_;
  ParameterBuffer buffer_;
  Board board_;
  ceres::Problem problem_;
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering_ =
      std::make_shared<ceres::ParameterBlockOrdering>();
};

}  // namespace

BoardState minimise_reprojection(const BoardObservations& observations,
                                 BoardState start,
                                 const ReprojectionProblem& problem) {
  return Minimisation(observations, start, problem).solve();
}

}  // namespace vernier
