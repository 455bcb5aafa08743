// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibrate.h"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calib/error.h"
#include "calib/small_sample_covariance.h"
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
    values_.resize(intrinsics_ + 6 * (cameras_ + state.frames.size()));
    for (std::size_t c = 0; c < cameras_; ++c) {
      const Eigen::VectorXd& a = rig_.cameras[c].parameters;
      std::copy(a.begin(), a.end(), intrinsics(static_cast<int>(c)));
      write_block(rig_.T_camera_first[c], camera_pose(static_cast<int>(c)));
    }
    for (std::size_t f = 0; f < state.frames.size(); ++f) {
      write_block(state.T_first_board[f], board(f));
    }
  }

  double* intrinsics(int camera) { return values_.data() + intrinsics_index(rig_, camera); }
  double* camera_pose(int camera) { return values_.data() + intrinsics_ + 6 * camera; }
  double* board(std::size_t frame) { return values_.data() + intrinsics_ + 6 * (cameras_ + frame); }

  void write_to(BoardState& state) {
    for (std::size_t c = 0; c < cameras_; ++c) {
      Eigen::VectorXd& a = state.rig.cameras[c].parameters;
      a = Eigen::Map<Eigen::VectorXd>(intrinsics(static_cast<int>(c)), a.size());
      if (c > 0) state.rig.T_camera_first[c] = read_block(camera_pose(static_cast<int>(c)));
    }
    for (std::size_t f = 0; f < state.frames.size(); ++f) {
      state.T_first_board[f] = read_block(board(f));
    }
  }

 private:
  Rig rig_;
  std::size_t intrinsics_, cameras_;
  std::vector<double> values_;
};

/// Residuals of one view: blocks are the intrinsics, the board's pose and, for every camera but
/// the first, the camera's pose.
class ViewCost : public ceres::CostFunction {
 public:
  ViewCost(const BoardObservations& observations, const BoardView& view, const Camera& camera)
      : observations_(observations), view_(view), camera_(camera) {
    set_num_residuals(2 * static_cast<int>(view.ids.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(camera.parameters.size()));
    mutable_parameter_block_sizes()->push_back(6);
    if (view.camera > 0) mutable_parameter_block_sizes()->push_back(6);
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    Camera camera = camera_;
    camera.parameters = Eigen::Map<const Eigen::VectorXd>(blocks[0], camera_.parameters.size());
    const Pose T_first_board = read_block(blocks[1]);
    const Pose T_camera_first = view_.camera > 0 ? read_block(blocks[2]) : Pose{};
    ViewLinearisation J;
    linearise_view(camera, T_camera_first, T_first_board, observations_.target_m, view_,
                   jacobians ? Linearise::with_jacobian : Linearise::residual_only, J);
    const auto rows = num_residuals();
    Eigen::Map<Eigen::VectorXd>(residuals, rows) = J.residual_px;
    if (jacobians && jacobians[0]) {
      Eigen::Map<RowMajor>(jacobians[0], rows, J.by_camera.cols()) = J.by_camera;
    }
    if (jacobians && jacobians[1]) write_pose(J.by_board_pose, blocks[1], jacobians[1]);
    if (jacobians && view_.camera > 0 && jacobians[2]) {
      write_pose(J.by_camera_pose, blocks[2], jacobians[2]);
    }
    return J.residual_px.allFinite();
  }

 private:
  static void write_pose(const Eigen::Matrix<double, Eigen::Dynamic, 6>& by_tangent,
                         const double* block,
                         double* out) {
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>> J(out, by_tangent.rows(),
                                                                            6);
    J.leftCols<3>() = by_tangent.leftCols<3>() * left_jacobian({block[0], block[1], block[2]});
    J.rightCols<3>() = by_tangent.rightCols<3>();
  }

  const BoardObservations& observations_;
  const BoardView& view_;
  const Camera& camera_;
};

ceres::Solver::Options solver_options(int max_iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = max_iterations;
  options.function_tolerance = 1e-15;
  options.parameter_tolerance = 1e-13;
  options.gradient_tolerance = 1e-13;
  options.jacobi_scaling = true;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;  // sums in one order: the same bits every time
  return options;
}

constexpr double frames_per_parameter = 3;  // enough for the clustered covariance as it is

/// The covariance to be sampled, from the normal equations in units of one pixel.
Covariance honest_covariance(const ReducedNormalEquations& unit,
                             const Eigen::MatrixXd& unit_bound,
                             const std::vector<std::string>& names) {
  const auto frames = static_cast<double>(unit.scores.cols());
  if (frames >= frames_per_parameter * static_cast<double>(names.size())) {
    return {CovarianceKind::clustered, names,
            clustered_sandwich(unit, unit_bound, frames_per_parameter)};
  }
  return {CovarianceKind::jackknife, names, small_sample_covariance(unit, unit_bound).matrix};
}

/// What the two covariances together say.
std::vector<std::string> warnings_of(const RigEstimate& estimate) {
  const Eigen::ArrayXd ratio =
      (estimate.covariance->matrix.diagonal().array() / estimate.covariance_mvb->diagonal().array())
          .sqrt();
  const double typical = std::exp(ratio.log().mean());
  if (typical < 1.3) return {};
  return {
      fmt::format("residuals of one view depend on each other: standard deviations are {:.1f} "
                  "times those of the minimum variance bound",
                  typical)};
}

}  // namespace

BoardState minimise_reprojection(const BoardObservations& observations,
                                 BoardState state,
                                 int max_iterations) {
  const std::vector<Camera> models = state.rig.cameras;  // sizes and models for the cost
  ParameterBuffer buffer(state);
  ceres::Problem problem;
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  std::size_t frame = 0;
  for (const BoardView& view : observations.views) {
    while (state.frames[frame] != view.frame) ++frame;
    std::vector<double*> blocks{buffer.intrinsics(view.camera), buffer.board(frame)};
    if (view.camera > 0) blocks.push_back(buffer.camera_pose(view.camera));
    problem.AddResidualBlock(new ViewCost(observations, view, models[view.camera]), nullptr,
                             blocks);
    ordering->AddElementToGroup(blocks[0], 1);
    ordering->AddElementToGroup(blocks[1], 0);
    if (view.camera > 0) ordering->AddElementToGroup(blocks[2], 1);
  }
  ceres::Solver::Options options = solver_options(max_iterations);
  options.linear_solver_ordering = ordering;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable() || summary.termination_type == ceres::NO_CONVERGENCE) {
    throw Error("calibration", "the minimisation did not converge: " + summary.message,
                "look at the corners: a mirrored or turned board, or swapped cameras, do this");
  }
  buffer.write_to(state);
  return state;
}

RigEstimate calibrate(BoardObservations observations, const CalibrationOptions& options) {
  check_and_sort(observations);
  const std::vector<CameraModel> models(observations.size_px.size(), options.model);
  const BoardState state = minimise_reprojection(observations, initial_state(observations, models),
                                                 options.max_iterations);

  const ReducedNormalEquations unit = reduced_normal_equations(observations, state, 1.0);
  const auto frames = state.frames.size();
  CalibrationSummary summary;
  summary.views = static_cast<int>(frames);
  summary.rms_px = std::sqrt(unit.chi2 / unit.residuals);
  summary.dof = unit.residuals - parameter_count(state.rig) - 6 * static_cast<int>(frames);
  if (summary.dof <= 0) {
    throw Error("calibration", "fewer corner coordinates than unknowns", "add views");
  }
  summary.pixel_sigma_px =
      options.pixel_sigma_px > 0 ? options.pixel_sigma_px : std::sqrt(unit.chi2 / summary.dof);
  const double variance = summary.pixel_sigma_px * summary.pixel_sigma_px;
  summary.chi2 = unit.chi2 / variance;

  RigEstimate estimate;
  estimate.rig = state.rig;
  const std::vector<std::string> names = parameter_names(state.rig);
  const Eigen::MatrixXd unit_bound = minimum_variance_bound(unit, names);
  estimate.covariance_mvb = variance * unit_bound;
  estimate.covariance = options.white_noise
                            ? Covariance{CovarianceKind::mvb, names, *estimate.covariance_mvb}
                            : honest_covariance(unit, unit_bound, names);
  summary.warnings = warnings_of(estimate);
  estimate.calibration = std::move(summary);
  estimate.evidence =
      CalibrationEvidence{std::move(observations), state.frames, state.T_first_board};
  return estimate;
}

}  // namespace vernier
