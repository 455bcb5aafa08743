// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/frame_scatter.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "calib/base/decompositions.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/pair_checks.h"
#include "calib/camera.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/solver/normal_equations.h"
#include "calib/solver/pair_equations.h"

namespace vernier::internal {
namespace {

constexpr std::size_t fewest_frames = 4;
constexpr std::size_t fewest_on_a_side = 3;  // of a split
constexpr double least_determined = 1e-7;    // of the information scaled to a unit diagonal

/// gᵀ A⁻¹ g over the directions that A determines, and their number.
struct Explained {
  double sum = 0;
  int directions = 0;
};

Explained explained(const Eigen::MatrixXd& A, const Eigen::VectorXd& g) {
  // a parameter without influence, such as the baseline's length of a rectified pair, has no part
  const Eigen::VectorXd scale =
      A.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 0; });
  const SymmetricEigen eigen(scale.asDiagonal() * A * scale.asDiagonal());
  Explained result;
  const Eigen::VectorXd z = eigen.eigenvectors().transpose() * (scale.asDiagonal() * g);
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    if (eigen.eigenvalues()[i] < least_determined) continue;
    result.sum += z[i] * z[i] / eigen.eigenvalues()[i];
    ++result.directions;
  }
  return result;
}

/// Equations of frames at a minimum, and what was seen.
struct Evidence {
  std::vector<int> frames;  ///< their numbers
  ReducedNormalEquations equations;
  std::vector<std::vector<std::size_t>> corners;  ///< by camera and place of the frame
  double dof = 0;
  double px = 1;  ///< of a residual
};

Evidence evidence_of(const BoardObservations& observations, const BoardState& state) {
  Evidence e;
  e.frames = state.frames;
  e.equations = reduced_normal_equations(observations, state, 1);
  e.corners.resize(state.rig.cameras.size());
  for (const BoardView& view : observations.views) {
    const auto at = std::lower_bound(state.frames.begin(), state.frames.end(), view.frame);
    auto& of_camera = e.corners[static_cast<std::size_t>(view.camera)];
    of_camera.resize(state.frames.size());
    of_camera[static_cast<std::size_t>(at - state.frames.begin())] = view.ids.size();
  }
  e.dof = e.equations.residuals - 6.0 * static_cast<double>(state.frames.size()) -
          static_cast<double>(e.equations.information.rows());
  return e;
}

/// Takes from the scores and the cost what another rig for all frames explains, to first order, and
/// holds directions that the frames do not determine, such as the length of a baseline.
void take_common_change(ReducedNormalEquations& equations) {
  Eigen::MatrixXd& S = equations.information;
  const double largest = S.diagonal().maxCoeff();
  for (Eigen::Index i = 0; i < S.rows(); ++i) {
    S(i, i) += least_determined * (S(i, i) > 0 ? S(i, i) : largest);
  }
  const Eigen::VectorXd g = equations.scores.rowwise().sum();
  const Eigen::VectorXd step = -solve_symmetric(S, g);
  for (std::size_t f = 0; f < equations.frame_information.size(); ++f) {
    equations.scores.col(static_cast<Eigen::Index>(f)) += equations.frame_information[f] * step;
  }
  equations.chi2 += g.dot(step);
}

Evidence evidence_of(const PairObservations& pairs, const Rig& rig) {
  Evidence e;
  double sigma_px = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) sigma_px += pairs.sigma_of(i);
  e.px = sigma_px / static_cast<double>(pairs.size());
  e.equations = pair_equations(pairs, rig, {}, 1);
  take_common_change(e.equations);
  std::vector<std::size_t> counts;
  for (const ImagePair& image : pairs.image_pairs) {
    e.frames.push_back(image.number);
    counts.push_back(image.count);
  }
  e.corners = {counts, counts};
  e.dof = e.equations.residuals - static_cast<double>(e.equations.information.rows());
  return e;
}

class ScatterTest {
 public:
  ScatterTest(const Rig& rig, Evidence evidence) : rig_(rig), seen_(std::move(evidence)) {}

  std::vector<FrameScatter> run() const {
    std::vector<FrameScatter> all;
    for (int c = 0; c < static_cast<int>(rig_.cameras.size()); ++c) {
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
      for (int i = 0; i < 6; ++i) result.push_back(pose_index(rig_, camera) + i);
      return result;
    }
    const int first = intrinsics_index(rig_, camera);
    const auto n = rig_.cameras[static_cast<std::size_t>(camera)].parameters.size();
    if (!all) return {first, first + 2, first + 3};
    for (Eigen::Index i = 0; i < n; ++i) result.push_back(first + i);
    return result;
  }

  std::size_t corners_in(int camera, std::size_t frame) const {
    const auto& of_camera = seen_.corners[static_cast<std::size_t>(camera)];
    return frame < of_camera.size() ? of_camera[frame] : 0;
  }

  void conclude(FrameScatter& s, const Explained& e, double corners) const {
    if (e.directions == 0) return;
    const double chi2 = seen_.equations.chi2, rest_dof = seen_.dof - e.directions;
    if (!(chi2 > 0) || !(rest_dof > 0)) return;
    const double rest = std::max(chi2 - e.sum, 1e-3 * chi2) / rest_dof;
    s.f_ratio = e.sum / e.directions / rest;
    s.share = std::clamp((e.sum - e.directions * rest) / chi2, 0.0, 1.0);
    s.shift_px = seen_.px * std::sqrt(2 * s.share * chi2 / std::max(1.0, corners));
  }

  FrameScatter in_each_frame(Kept kept, int camera) const {
    FrameScatter s;
    s.kept = kept;
    s.camera = camera;
    const auto at = places(kept, camera, false);
    Explained sum;
    double corners = 0;
    for (std::size_t f = 0; f < seen_.frames.size(); ++f) {
      const std::size_t seen = corners_in(camera, f);
      if (seen == 0) continue;
      const Eigen::VectorXd g = seen_.equations.scores.col(static_cast<Eigen::Index>(f));
      const Explained e = explained(seen_.equations.frame_information[f](at, at), g(at));
      if (e.directions == 0) continue;
      sum.sum += e.sum;
      sum.directions += e.directions;
      corners += static_cast<double>(seen);
      ++s.frames;
      if (e.sum <= s.worst_share * seen_.equations.chi2) continue;
      s.worst_share = e.sum / seen_.equations.chi2;
      s.worst_frame = seen_.frames[f];
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
    const Eigen::MatrixXd& S = seen_.equations.information;
    Eigen::MatrixXd before = Eigen::MatrixXd::Zero(S.rows(), S.cols());
    Eigen::VectorXd g = Eigen::VectorXd::Zero(S.rows());
    Explained most;
    double corners = 0;
    std::vector<std::size_t> seen;
    for (std::size_t f = 0; f < seen_.frames.size(); ++f) {
      if (corners_in(camera, f) == 0) continue;
      corners += static_cast<double>(corners_in(camera, f));
      seen.push_back(f);
    }
    for (std::size_t f = 0, count = 0; f < seen_.frames.size(); ++f) {
      before += seen_.equations.frame_information[f];
      g += seen_.equations.scores.col(static_cast<Eigen::Index>(f));
      count += corners_in(camera, f) > 0;
      if (count < fewest_on_a_side || count + fewest_on_a_side > seen.size()) continue;
      const Eigen::MatrixXd half = before(Eigen::all, at);
      Eigen::MatrixXd A = before(at, at) - half.transpose() * solve_symmetric(S, half);
      A = 0.5 * (A + A.transpose()).eval();
      const Explained e = explained(A, g(at));
      if (e.sum <= most.sum) continue;
      most = e;
      best.last_frame = seen_.frames[f];
    }
    best.frames = static_cast<int>(seen.size());
    conclude(best, most, corners);
    return best;
  }

  const Rig& rig_;
  Evidence seen_;
};

}  // namespace

std::vector<FrameScatter> frame_scatter(const BoardObservations& observations,
                                        const BoardState& state) {
  if (state.frames.size() < fewest_frames) return {};
  return ScatterTest(state.rig, evidence_of(observations, state)).run();
}

std::vector<FrameScatter> frame_scatter(const PairObservations& pairs, const Rig& rig) {
  std::vector<bool> kept(pairs.size(), false);
  for (const ImagePair& image : pairs.image_pairs) {
    if (image.count < fewest_judged_matches) continue;
    std::fill_n(kept.begin() + static_cast<std::ptrdiff_t>(image.first), image.count, true);
  }
  const PairObservations enough = selected(pairs, kept);
  if (enough.image_pairs.size() < fewest_frames) return {};
  return ScatterTest(rig, evidence_of(enough, rig)).run();
}

}  // namespace vernier::internal
