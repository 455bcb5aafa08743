// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// One evaluation of the restricted likelihood with its gradient (field, motion and shape; 54
// points, `opencv4`; its information too), and the same with the dense matrices of each frame. CPU
// time, one thread.
#include <benchmark/benchmark.h>

#include <Eigen/Core>
#include <vector>

#include "calib/base/decompositions.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/estimate/held_parameters.h"
#include "calib/lens_models.h"
#include "calib/noise/corner_covariance.h"
#include "calib/noise/field_spectrum.h"
#include "calib/noise/frame_rows.h"
#include "calib/noise/noise_of_estimate.h"
#include "calib/noise/restricted_likelihood.h"
#include "calib/simulated_board.h"
#include "datasets/shipped.h"

namespace {

using namespace vernier;
using namespace vernier::internal;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr CornerNoise noise{.white_px = 0.1,
                            .field_px = 0.05,
                            .field_length_m = 0.1,
                            .motion_rad = 1e-3,
                            .motion_m = 2e-4,
                            .shape_plane_m = 5e-5,
                            .shape_height_m = 1.4e-4};

RigEstimate calibration(int frames) {
  const SimulatedBoardOptions options{.seed = 5, .frames = frames, .distance_m = 0.8};
  const auto board = simulate_board(datasets::nominal_truth(), {9, 6, 0.025}, options);
  return calibrate(board.observations, {.model = OpenCv4{}});
}

/// The formulas of calib/noise/restricted_likelihood.h, V, Q and P of each frame dense.
class DenseFrames {
 public:
  explicit DenseFrames(const RigEstimate& estimate)
      : target_m_(estimate.evidence->observations.target_m) {
    const auto& evidence = *estimate.evidence;
    rows_ = frame_rows(evidence.observations,
                       {estimate.rig, evidence.frames, evidence.T_first_board, evidence.warp_m},
                       free_directions(estimate.rig, held_parameters(estimate)));
    const Index rig = rows_[0].by_rig.cols(), shape = 3 * static_cast<Index>(target_m_.size());
    for (const FrameRows& frame : rows_) {
      MatrixXd& A = A_.emplace_back(MatrixXd::Zero(frame.residual_px.size(), rig + shape));
      A.leftCols(rig) = frame.by_rig;
      for (const ViewRows& view : frame.views) {
        const auto n = static_cast<Index>(view.ids.size());
        for (Index i = 0; i < 2 * n; ++i) {
          const Index at = rig + 3 * view.ids[static_cast<std::size_t>(i % n)];
          A.block<1, 3>(view.first + i, at) = frame.by_point.row(view.first + i);
        }
      }
    }
  }

  VectorXd gradient() const {
    const Index unknowns = A_[0].cols(), shape = 3 * static_cast<Index>(target_m_.size());
    std::vector<MatrixXd> Q, QA;
    MatrixXd S = MatrixXd::Zero(unknowns, unknowns);
    VectorXd score = VectorXd::Zero(unknowns), prior(shape);
    for (Index i = 0; i < shape; ++i) {
      const double s = i % 3 < 2 ? noise.shape_plane_m : noise.shape_height_m;
      prior[i] = 1 / (s * s);
    }
    S.diagonal().tail(shape) = prior;
    for (std::size_t f = 0; f < rows_.size(); ++f) {
      const Cholesky V(corner_covariance(rows_[f], noise, target_m_));
      const MatrixXd ViB = V.solve(MatrixXd(rows_[f].by_pose));
      const MatrixXd N = rows_[f].by_pose.transpose() * ViB;
      Q.push_back(V.inverse() - ViB * Cholesky(N).solve(MatrixXd(ViB.transpose())));
      QA.push_back(Q[f] * A_[f]);
      S += A_[f].transpose() * QA[f];
      score += QA[f].transpose() * rows_[f].residual_px;
    }
    const VectorXd scale = S.diagonal().cwiseSqrt().cwiseInverse();
    const Cholesky factor(scale.asDiagonal() * S * scale.asDiagonal());
    const MatrixXd root = factor.solve_lower(MatrixXd(scale.asDiagonal()));
    const VectorXd z = -root.transpose() * (root * score);
    VectorXd gradient = VectorXd::Zero(7);
    for (std::size_t f = 0; f < rows_.size(); ++f) {
      const MatrixXd half = QA[f] * root.transpose();
      const VectorXd e = Q[f] * rows_[f].residual_px + QA[f] * z;
      add(rows_[f], Q[f] - half * half.transpose() - e * e.transpose(), gradient);
    }
    for (Index i = 0; i < shape; ++i) {
      const double spread = root.col(unknowns - shape + i).squaredNorm() +
                            z[unknowns - shape + i] * z[unknowns - shape + i];
      gradient[i % 3 < 2 ? 5 : 6] += 2 * (1 - spread * prior[i]);
    }
    return gradient;
  }

 private:
  /// tr(∂V (P − P r rᵀ P)) of one frame.
  void add(const FrameRows& frame, const MatrixXd& PV, VectorXd& gradient) const {
    const double power = noise.field_px * noise.field_px;
    gradient[0] += 2 * noise.white_px * noise.white_px * PV.trace();
    for (const ViewRows& view : frame.views) {
      std::vector<Eigen::Vector3d> seen;
      for (const int id : view.ids) seen.push_back(target_m_[static_cast<std::size_t>(id)]);
      const auto n = static_cast<Index>(seen.size());
      const MatrixXd K = field_correlation(seen, noise.field_length_m);
      const MatrixXd by_log_length =
          K.cwiseProduct(squared_distances(seen)) / (noise.field_length_m * noise.field_length_m);
      for (int uv = 0; uv < 2; ++uv) {
        const auto block = PV.block(view.first + uv * n, view.first + uv * n, n, n);
        gradient[1] += 2 * power * K.cwiseProduct(block).sum();
        gradient[2] += power * by_log_length.cwiseProduct(block).sum();
      }
    }
    const MatrixXd G = frame.by_motion.transpose() * PV * frame.by_motion;
    for (Index m = 0; m < G.rows(); ++m) {
      const double s = m % 6 < 3 ? noise.motion_rad : noise.motion_m;
      gradient[m % 6 < 3 ? 3 : 4] += 2 * s * s * G(m, m);
    }
  }

  std::vector<Eigen::Vector3d> target_m_;
  std::vector<FrameRows> rows_;
  std::vector<MatrixXd> A_;
};

VectorXd gradient_at(const RestrictedLikelihood& likelihood) {
  return likelihood.at(noise, RestrictedLikelihood::Want::gradient).gradient;
}

void likelihood_and_gradient(benchmark::State& state) {
  const auto likelihood =
      noise_likelihood(calibration(static_cast<int>(state.range(0))), {.shape = true});
  for (auto _ : state) benchmark::DoNotOptimize(gradient_at(likelihood));
}

void dense_frames(benchmark::State& state) {
  const RigEstimate estimate = calibration(static_cast<int>(state.range(0)));
  const DenseFrames dense(estimate);
  const VectorXd expected = gradient_at(noise_likelihood(estimate, {.shape = true}));
  if ((dense.gradient() - expected).norm() > 1e-5 * expected.norm()) {
    state.SkipWithError("another gradient than that of the likelihood");
  }
  for (auto _ : state) benchmark::DoNotOptimize(dense.gradient());
}

BENCHMARK(likelihood_and_gradient)->Arg(14)->Arg(28)->Unit(benchmark::kMillisecond);
BENCHMARK(dense_frames)->Arg(14)->Arg(28)->Unit(benchmark::kMillisecond);

}  // namespace
