// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/frame_scatter.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "calib/base/decompositions.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/rig.h"
#include "calib/solver/normal_equations.h"

namespace vernier::internal {
namespace {

constexpr std::size_t fewest_frames = 4;
constexpr std::size_t fewest_on_a_side = 3;  // of a split

/// gᵀ A⁻¹ g over the directions that A determines, and their number.
struct Explained {
  double sum = 0;
  int directions = 0;
};

Explained explained(const Eigen::MatrixXd& A, const Eigen::VectorXd& g) {
  const Eigen::VectorXd diagonal = A.diagonal();
  if (!(diagonal.minCoeff() > 0)) return {};
  const Eigen::VectorXd scale = diagonal.cwiseSqrt().cwiseInverse();
  const SymmetricEigen eigen(scale.asDiagonal() * A * scale.asDiagonal());
  Explained result;
  const Eigen::VectorXd z = eigen.eigenvectors().transpose() * (scale.asDiagonal() * g);
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    if (eigen.eigenvalues()[i] < 1e-7) continue;
    result.sum += z[i] * z[i] / eigen.eigenvalues()[i];
    ++result.directions;
  }
  return result;
}

class ScatterTest {
 public:
  ScatterTest(const BoardObservations& observations, const BoardState& state)
      : state_(state),
        equations_(reduced_normal_equations(observations, state, 1)),
        corners_(state.rig.cameras.size()) {
    for (const BoardView& view : observations.views) {
      const auto at = std::lower_bound(state.frames.begin(), state.frames.end(), view.frame);
      auto& of_camera = corners_[static_cast<std::size_t>(view.camera)];
      of_camera.resize(state.frames.size());
      of_camera[static_cast<std::size_t>(at - state.frames.begin())] = view.ids.size();
    }
    dof_ = equations_.residuals - 6.0 * static_cast<double>(state.frames.size()) -
           static_cast<double>(equations_.information.rows());
  }

  std::vector<FrameScatter> run() const {
    std::vector<FrameScatter> all;
    for (int c = 0; c < static_cast<int>(state_.rig.cameras.size()); ++c) {
      for (const Kept kept : {Kept::pose, Kept::lens}) {
        if (kept == Kept::pose && c == 0) continue;
        all.push_back(in_each_frame(kept, c));
        all.push_back(best_split(kept, c));
      }
    }
    return all;
  }

 private:
  std::vector<Eigen::Index> places(Kept kept, int camera, bool all) const {
    std::vector<Eigen::Index> result;
    if (kept == Kept::pose) {
      for (int i = 0; i < 6; ++i) result.push_back(pose_index(state_.rig, camera) + i);
      return result;
    }
    const int first = intrinsics_index(state_.rig, camera);
    const auto n = state_.rig.cameras[static_cast<std::size_t>(camera)].parameters.size();
    if (!all) return {first, first + 2, first + 3};
    for (Eigen::Index i = 0; i < n; ++i) result.push_back(first + i);
    return result;
  }

  std::size_t corners_in(int camera, std::size_t frame) const {
    const auto& of_camera = corners_[static_cast<std::size_t>(camera)];
    return frame < of_camera.size() ? of_camera[frame] : 0;
  }

  void conclude(FrameScatter& s, const Explained& e, double corners) const {
    if (e.directions == 0) return;
    const double chi2 = equations_.chi2, rest_dof = dof_ - e.directions;
    if (!(chi2 > 0) || !(rest_dof > 0)) return;
    const double rest = std::max(chi2 - e.sum, 1e-3 * chi2) / rest_dof;
    s.f_ratio = e.sum / e.directions / rest;
    s.share = std::clamp((e.sum - e.directions * rest) / chi2, 0.0, 1.0);
    s.shift_px = std::sqrt(2 * s.share * chi2 / std::max(1.0, corners));
  }

  FrameScatter in_each_frame(Kept kept, int camera) const {
    FrameScatter s;
    s.kept = kept;
    s.camera = camera;
    const auto at = places(kept, camera, false);
    Explained sum;
    double corners = 0;
    for (std::size_t f = 0; f < state_.frames.size(); ++f) {
      const std::size_t seen = corners_in(camera, f);
      if (seen == 0) continue;
      const Eigen::VectorXd g = equations_.scores.col(static_cast<Eigen::Index>(f));
      const Explained e = explained(equations_.frame_information[f](at, at), g(at));
      if (e.directions == 0) continue;
      sum.sum += e.sum;
      sum.directions += e.directions;
      corners += static_cast<double>(seen);
      ++s.frames;
      if (e.sum <= s.worst_share * equations_.chi2) continue;
      s.worst_share = e.sum / equations_.chi2;
      s.worst_frame = state_.frames[f];
    }
    conclude(s, sum, corners);
    return s;
  }

  FrameScatter best_split(Kept kept, int camera) const {
    FrameScatter best;
    best.kept = kept;
    best.camera = camera;
    best.is_split = true;
    const auto at = places(kept, camera, true);
    const Eigen::MatrixXd& S = equations_.information;
    Eigen::MatrixXd before = Eigen::MatrixXd::Zero(S.rows(), S.cols());
    Eigen::VectorXd g = Eigen::VectorXd::Zero(S.rows());
    Explained most;
    double corners = 0;
    std::vector<std::size_t> seen;
    for (std::size_t f = 0; f < state_.frames.size(); ++f) {
      if (corners_in(camera, f) == 0) continue;
      corners += static_cast<double>(corners_in(camera, f));
      seen.push_back(f);
    }
    for (std::size_t f = 0, count = 0; f < state_.frames.size(); ++f) {
      before += equations_.frame_information[f];
      g += equations_.scores.col(static_cast<Eigen::Index>(f));
      count += corners_in(camera, f) > 0;
      if (count < fewest_on_a_side || count + fewest_on_a_side > seen.size()) continue;
      const Eigen::MatrixXd half = before(Eigen::all, at);
      Eigen::MatrixXd A = before(at, at) - half.transpose() * solve_symmetric(S, half);
      A = 0.5 * (A + A.transpose()).eval();
      const Explained e = explained(A, g(at));
      if (e.sum <= most.sum) continue;
      most = e;
      best.last_frame = state_.frames[f];
    }
    best.frames = static_cast<int>(seen.size());
    conclude(best, most, corners);
    return best;
  }

  const BoardState& state_;
  ReducedNormalEquations equations_;
  std::vector<std::vector<std::size_t>> corners_;  // by camera and place of the frame
  double dof_ = 0;
};

}  // namespace

std::vector<FrameScatter> frame_scatter(const BoardObservations& observations,
                                        const BoardState& state) {
  if (state.frames.size() < fewest_frames) return {};
  return ScatterTest(observations, state).run();
}

}  // namespace vernier::internal
