// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/minimise_reprojection.h"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "calib/base/decompositions.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "calib/solver/pair_cost.h"
#include "calib/solver/parameter_buffer.h"
#include "calib/solver/reprojection_problem.h"
#include "calib/solver/view_cost.h"

namespace vernier::internal {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A prior as residuals σ H δ with P = HᵀH: blocks are all intrinsics, then all camera poses but
/// the first.
class PriorCost : public ceres::CostFunction {
 public:
  PriorCost(const RigPrior& prior, double pixel_sigma_px) : prior_(prior) {
    const SymmetricEigen eigen(prior.information);
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
  options.initial_trust_region_radius = 1e12;  // Gauss-Newton steps until one fails
  options.jacobi_scaling = true;
  // Columns are scaled to one: a damping of at least 1e-12 keeps the Schur complement positive
  // definite for a model that the views hardly determine.
  options.max_trust_region_radius = 1e12;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;  // sums in one order: the same bits every time
  return options;
}

constexpr double largest_valley_px = 20;  ///< larger residuals are of wrong corners

/// Indices of a camera's parameters among the rig's.
std::vector<int> parameters_of(const Rig& rig, int camera) {
  std::vector<int> own(static_cast<std::size_t>(rig.cameras[camera].parameters.size()));
  std::iota(own.begin(), own.end(), intrinsics_index(rig, camera));
  for (int k = 0; camera > 0 && k < 6; ++k) own.push_back(pose_index(rig, camera) + k);
  return own;
}

/// Throws Error for a camera without any data or prior.
void check_cameras(const BoardObservations& observations,
                   const Rig& rig,
                   const ReprojectionProblem& problem) {
  const auto known = [&](int i) {
    return (!problem.held.empty() && problem.held[i]) ||
           std::any_of(problem.priors.begin(), problem.priors.end(),
                       [&](const RigPrior& prior) { return prior.information(i, i) > 0; });
  };
  for (int c = 0; c < static_cast<int>(rig.cameras.size()); ++c) {
    if (c < 2 && problem.pairs.size() > 0) continue;
    const auto sees = [&](const BoardView& view) { return view.camera == c; };
    if (std::any_of(observations.views.begin(), observations.views.end(), sees)) continue;
    const std::vector<int> own = parameters_of(rig, c);
    const auto unknown = std::find_if_not(own.begin(), own.end(), known);
    if (unknown == own.end()) continue;
    const std::string name = parameter_names(rig)[static_cast<std::size_t>(*unknown)];
    throw Error(fmt::format("camera {} (\"{}\")", c, rig.cameras[c].name),
                "it has no view of the board, and no prior gives its " +
                    name.substr(rig.cameras[c].name.size() + 1),
                "add views of it, or give fixed values or priors for all of its parameters");
  }
}

/// Whether the last twenty iterations changed nothing but rounding.
bool moves_no_more(const ceres::Solver::Summary& summary) {
  const auto& steps = summary.iterations;
  return steps.size() > 20 &&
         steps[steps.size() - 21].cost - summary.final_cost <= 1e-12 * summary.final_cost;
}

/// Evaluates all residuals before Ceres requests the first.
class AllResiduals : public ceres::EvaluationCallback {
 public:
  AllResiduals(CompressedViews& views, CompressedPairs* pairs) : views_(views), pairs_(pairs) {}
  void PrepareForEvaluation(bool jacobians, bool new_point) override {
    views_.PrepareForEvaluation(jacobians, new_point);
    if (pairs_) pairs_->PrepareForEvaluation(jacobians, new_point);
  }

 private:
  CompressedViews& views_;
  CompressedPairs* pairs_;
};

/// Builds the Ceres problem of one calibration and owns the data its blocks refer to.
class Minimisation {
 public:
  Minimisation(const BoardObservations& observations,
               const BoardState& start,
               const ReprojectionProblem& what)
      : start_(start),
        what_(what),
        buffer_(start),
        views_(observations, start, what, buffer_),
        pairs_(pairs_of(start, what, buffer_)),
        all_(views_, pairs_.get()),
        problem_(problem_options(&all_)) {
    add_views(observations);
    add_pairs();
    add_priors();
    hold();
  }

  BoardState solve() {
    ceres::Solver::Options options = solver_options(what_.max_iterations);
    options.linear_solver_ordering = ordering_;
    ceres::Solver::Summary summary;
    const std::vector<Block> begin = blocks();
    ceres::Solve(options, &problem_, &summary);
    if (what_.must_converge && summary.termination_type == ceres::NO_CONVERGENCE &&
        rms_px(summary) < largest_valley_px) {
      // Steps that may go up leave the curved valley of a lens that the views hardly determine.
      options.use_nonmonotonic_steps = true;
      options.max_num_iterations = 10 * what_.max_iterations;
      for (const Block& block : begin) std::copy(block.value.begin(), block.value.end(), block.at);
      ceres::Solve(options, &problem_, &summary);
    }
    const bool at_rest = !what_.must_converge ||
                         summary.termination_type != ceres::NO_CONVERGENCE ||
                         moves_no_more(summary);
    if (!summary.IsSolutionUsable() || !at_rest) {
      throw Error("calibration", "the minimisation did not converge: " + summary.message,
                  what_.pairs.size() > 0
                      ? "check the matches, the prior, and left and right: many wrong matches, a "
                        "prior of other cameras or swapped images can cause this"
                      : "check the corners: a mirrored or rotated board, or swapped cameras, can "
                        "cause this");
    }
    BoardState state = start_;
    buffer_.write_to(state);
    return state;
  }

 private:
  struct Block {
    double* at;
    std::vector<double> value;
  };
  std::vector<Block> blocks() const {
    std::vector<double*> all;
    problem_.GetParameterBlocks(&all);
    std::vector<Block> result;
    for (double* at : all) result.push_back({at, {at, at + problem_.ParameterBlockSize(at)}});
    return result;
  }

  /// Of a coordinate, as if the priors had no part in the cost.
  double rms_px(const ceres::Solver::Summary& summary) const {
    return std::sqrt(2 * summary.final_cost / static_cast<double>(coordinates_));
  }

  static std::unique_ptr<CompressedPairs> pairs_of(const BoardState& start,
                                                   const ReprojectionProblem& what,
                                                   const ParameterBuffer& buffer) {
    if (what.pairs.size() == 0) return nullptr;
    return std::make_unique<CompressedPairs>(
        what.pairs, what.pair_weights, what.pixel_sigma_px / what.pair_sigma_scale, start, buffer);
  }

  static ceres::Problem::Options problem_options(ceres::EvaluationCallback* views) {
    ceres::Problem::Options options;
    options.evaluation_callback = views;
    return options;
  }

  void add_views(const BoardObservations& observations) {
    for (std::size_t v = 0; v < observations.views.size(); ++v) {
      const BoardView& view = observations.views[v];
      const std::size_t frame = frame_index(start_.frames, view.frame);
      coordinates_ += 2 * view.ids.size();
      std::vector<double*> blocks{buffer_.intrinsics(view.camera), buffer_.board(frame)};
      if (view.camera > 0) blocks.push_back(buffer_.camera_pose(view.camera));
      if (what_.warp == BoardWarp::free) blocks.push_back(buffer_.warp());
      problem_.AddResidualBlock(views_.cost(v).release(), nullptr, blocks);
      for (double* block : blocks) ordering_->AddElementToGroup(block, 1);
      ordering_->AddElementToGroup(blocks[1], 0);
    }
  }

  void add_pairs() {
    if (!pairs_) return;
    coordinates_ += 4 * what_.pairs.size();
    const std::vector<double*> blocks{buffer_.intrinsics(0), buffer_.intrinsics(1),
                                      buffer_.camera_pose(1)};
    problem_.AddResidualBlock(pairs_->cost().release(), nullptr, blocks);
    for (double* block : blocks) ordering_->AddElementToGroup(block, 1);
  }

  void add_priors() {
    std::vector<double*> blocks;
    const auto cameras = static_cast<int>(start_.rig.cameras.size());
    blocks.reserve(2 * start_.rig.cameras.size());
    for (int c = 0; c < cameras; ++c) blocks.push_back(buffer_.intrinsics(c));
    for (int c = 1; c < cameras; ++c) blocks.push_back(buffer_.camera_pose(c));
    for (const RigPrior& prior : what_.priors) {
      problem_.AddResidualBlock(new PriorCost(prior, what_.pixel_sigma_px), nullptr, blocks);
      for (double* block : blocks) ordering_->AddElementToGroup(block, 1);
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
    // Ceres does not have the block of a fully held camera without views.
    if (held.empty() || !problem_.HasParameterBlock(block)) return;
    if (static_cast<int>(held.size()) == size) {
      problem_.SetParameterBlockConstant(block);
    } else {
      problem_.SetManifold(block, new ceres::SubsetManifold(size, held));
    }
  }

  const BoardState& start_;
  const ReprojectionProblem& what_;
  ParameterBuffer buffer_;
  CompressedViews views_;
  std::unique_ptr<CompressedPairs> pairs_;
  AllResiduals all_;
  ceres::Problem problem_;
  std::size_t coordinates_ = 0;  ///< of all corners and pairs
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering_ =
      std::make_shared<ceres::ParameterBlockOrdering>();
};

}  // namespace

BoardState minimise_reprojection(const BoardObservations& observations,
                                 const BoardState& start,
                                 const ReprojectionProblem& problem) {
  check_problem(observations, start.rig, problem);
  check_cameras(observations, start.rig, problem);
  return Minimisation(observations, start, problem).solve();
}

}  // namespace vernier::internal
