// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/uncertainty/next_view.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "calib/base/decompositions.h"
#include "calib/board/board_placement.h"
#include "calib/board/board_warp.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "calib/solver/normal_equations.h"
#include "calib/uncertainty/target_quantity.h"

namespace vernier::internal {
namespace {

/// I + n Fᵀ S F, factored.
Cholesky gain(const Eigen::MatrixXd& F, const Eigen::MatrixXd& S, double n) {
  Eigen::MatrixXd M = n * F.transpose() * S * F;
  M.diagonal().array() += 1;
  return Cholesky(M);
}

double sd_after(const Eigen::MatrixXd& F, const CandidateView& view, const TargetQuantity& wanted) {
  // g F (L Lᵀ)⁻¹ Fᵀ gᵀ = |L⁻¹ Fᵀ gᵀ|²
  const Eigen::MatrixXd half =
      gain(F, view.information, 1).solve_lower(Eigen::MatrixXd((wanted.gradient * F).transpose()));
  return std::sqrt(half.squaredNorm() / static_cast<double>(wanted.gradient.rows()));
}

/// Standard deviations after adding each candidate alone.
std::vector<double> ratings(const Eigen::MatrixXd& F,
                            const std::vector<CandidateView>& candidates,
                            const TargetQuantity& wanted) {
  std::vector<double> sd;
  sd.reserve(candidates.size());
  for (const CandidateView& view : candidates) sd.push_back(sd_after(F, view, wanted));
  return sd;
}

/// Whether two placements differ by at most one step of each kind.
bool are_adjacent(const BoardPlacement& a, const BoardPlacement& b) {
  for (std::size_t kind = 0; kind < a.step.size(); ++kind) {
    if (std::abs(a.step[kind] - b.step[kind]) > 1) return false;
  }
  return true;
}

/// The best views that are adjacent neither to the first nor to one another.
std::vector<ScoredView> distinct_best(const std::vector<CandidateView>& candidates,
                                      const std::vector<double>& sd,
                                      double sd_before,
                                      int count) {
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return sd[i] < sd[j]; });
  std::vector<ScoredView> best;
  for (const std::size_t i : order) {
    if (static_cast<int>(best.size()) > count) break;
    const BoardPlacement& p = candidates[i].placement;
    if (std::any_of(best.begin(), best.end(),
                    [&](const ScoredView& v) { return are_adjacent(v.placement, p); })) {
      continue;
    }
    best.push_back({p, sd_before, sd[i]});
  }
  best.erase(best.begin());  // the first itself
  return best;
}

}  // namespace

std::vector<CandidateView> candidate_views(const Rig& rig,
                                           const std::vector<Eigen::Vector3d>& target_m,
                                           const Eigen::Vector2d& warp_m,
                                           double pixel_sigma_px,
                                           const PlacementOptions& options) {
  BoardObservations observations;
  observations.target_m = target_m;
  for (const Camera& camera : rig.cameras) observations.size_px.push_back(camera.size_px);
  std::vector<CandidateView> candidates;
  for (PlacedBoard& board : placed_boards(rig, warped_target(target_m, warp_m), options)) {
    observations.views = std::move(board.views);
    const BoardState state{rig, {0}, {board.placement.T_first_board}, warp_m};
    candidates.push_back(
        {board.placement,
         reduced_normal_equations(observations, state, pixel_sigma_px).information});
  }
  return candidates;
}

Eigen::MatrixXd updated_factor(const Eigen::MatrixXd& factor,
                               const Eigen::MatrixXd& information,
                               double times) {
  // F (L Lᵀ)⁻¹ Fᵀ = (L⁻¹ Fᵀ)ᵀ (L⁻¹ Fᵀ)
  return gain(factor, information, times).times_inverse_upper(factor);
}

ViewAdvice advise_views(const Eigen::MatrixXd& factor,
                        const std::vector<CandidateView>& candidates,
                        const TargetQuantity& wanted,
                        const ViewAdviceOptions& options) {
  if (candidates.empty()) throw Error("advice", "there is no candidate view", "");
  Eigen::MatrixXd F = factor;
  double before = sd_of(wanted, F);
  if (!(before > 0)) {
    throw Error(wanted.name,
                "its standard deviation is already 0: the parameters it depends on are fixed",
                "choose another quantity, or calibrate with them free");
  }
  ViewAdvice advice;
  const int steps = std::max(options.views, options.more);
  for (int step = 0; step < steps; ++step) {
    const std::vector<double> sd = ratings(F, candidates, wanted);
    const auto best = std::min_element(sd.begin(), sd.end()) - sd.begin();
    if (step == 0) {
      const auto worst = std::max_element(sd.begin(), sd.end()) - sd.begin();
      advice.worst_candidate = {candidates[worst].placement, before, sd[worst]};
      advice.alternatives = distinct_best(candidates, sd, before, options.alternatives);
    }
    if (step < options.views) {
      advice.views.push_back({candidates[best].placement, before, sd[best]});
    }
    advice.sd_after_more.push_back(sd[best]);
    F = updated_factor(F, candidates[best].information);
    before = sd[best];
  }
  return advice;
}

}  // namespace vernier::internal
