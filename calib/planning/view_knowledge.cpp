// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/board_target.h"
#include "calib/error.h"
#include "calib/estimate/held_parameters.h"
#include "calib/estimate/rig_part.h"
#include "calib/planning/frame_kinds.h"
#include "calib/planning/smooth_noise.h"
#include "calib/planning/view_population.h"
#include "calib/planning/views_needed.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"
#include "calib/sampler.h"
#include "calib/simulated_board.h"
#include "calib/solver/linearised_cost.h"
#include "calib/solver/normal_equations.h"

namespace vernier::internal {
namespace {

constexpr int pool_count = 24, views_per_pool = 60;
constexpr int fewest_views = 5;

/// S_f in the free directions.
std::vector<Eigen::MatrixXd> in_directions(const std::vector<Eigen::MatrixXd>& views,
                                           const Eigen::MatrixXd& free) {
  std::vector<Eigen::MatrixXd> restricted_views;
  restricted_views.reserve(views.size());
  for (const Eigen::MatrixXd& S : views) {
    restricted_views.emplace_back(free.transpose() * S * free);
  }
  return restricted_views;
}

bool is_by_all(const FrameKind& kind, const Rig& rig) {
  return kind.cameras.size() == rig.cameras.size();
}

/// Views that could follow those of one kind, by their poses in the first camera that sees them;
/// those themselves if there are too few to show how the board is held.
std::vector<Eigen::MatrixXd> views_like(const FrameKind& kind,
                                        const RigEstimate& calibration,
                                        const std::vector<Eigen::MatrixXd>& taken,
                                        const Eigen::MatrixXd& free,
                                        std::uint64_t seed,
                                        std::uint32_t number) {
  constexpr std::size_t enough = 3;
  if (kind.frames.size() < enough) {
    std::vector<Eigen::MatrixXd> same;
    for (const std::size_t f : kind.frames) same.push_back(taken[f]);
    return same;
  }
  const CalibrationEvidence& evidence = *calibration.evidence;
  const std::vector<Eigen::Vector3d>& target_m = evidence.observations.target_m;
  const Pose& T_camera_first =
      calibration.rig.T_camera_first[static_cast<std::size_t>(kind.cameras[0])];
  std::vector<Pose> T_camera_board;
  for (const std::size_t f : kind.frames) {
    T_camera_board.push_back(T_camera_first * evidence.T_first_board[f]);
  }
  const PosePopulation population =
      redrawn(pose_population(T_camera_board, target_m), seed, number);
  return in_directions(population_views(calibration.rig, target_m, evidence.warp_m, population,
                                        kind.cameras, views_per_pool, seed, number),
                       free);
}

/// That of all priors of a calibration; empty without one.
Eigen::MatrixXd information_of_priors(const RigEstimate& calibration, const Eigen::MatrixXd& free) {
  Eigen::MatrixXd information;
  for (const GaussianRigPrior& known : calibration.evidence->priors) {
    const RigPrior prior = rig_prior(calibration.rig, known);
    const Eigen::MatrixXd P = prior_information(prior, calibration.rig, free);
    information = information.size() > 0 ? Eigen::MatrixXd(information + P) : P;
  }
  return information;
}

}  // namespace

ViewKnowledge knowledge_of(const RigEstimate& calibration,
                           std::uint64_t seed,
                           const std::string& place) {
  if (!calibration.evidence || !calibration.calibration ||
      calibration.evidence->observations.views.empty()) {
    throw Error(place, "the file has no board views",
                "give a calibration written with its evidence, or --board for a datasheet");
  }
  const CalibrationEvidence& evidence = *calibration.evidence;
  ViewKnowledge known;
  known.taken = static_cast<int>(evidence.frames.size());
  if (known.taken < fewest_views) {
    throw Error(place, "fewer than five views do not show what further ones would bring",
                "take more views, or plan from a datasheet with --board");
  }
  const BoardState state{calibration.rig, evidence.frames, evidence.T_first_board, evidence.warp_m};
  const Eigen::MatrixXd free = free_directions(calibration.rig, held_parameters(calibration));
  const SmoothNoise noise =
      smooth_noise(evidence.observations, state, static_cast<int>(free.cols()));
  known.inflation = noise.inflation;
  known.noise_px = noise.sd_px;
  known.noise_log_sd = noise.log_sd;
  const std::vector<Eigen::MatrixXd> taken = in_directions(
      reduced_normal_equations(evidence.observations, state, 1).frame_information, free);
  const std::vector<FrameKind> kinds = frame_kinds(evidence.observations, evidence.frames);
  for (const FrameKind& kind : kinds) {
    if (is_by_all(kind, calibration.rig)) known.taken_by_all = static_cast<int>(kind.frames.size());
  }
  const Eigen::MatrixXd prior = information_of_priors(calibration, free);
  for (std::uint32_t pool = 0; pool < pool_count; ++pool) {
    known.pools.push_back({calibration.rig, free, taken, {}, prior});
    const std::vector<double> shares = drawn_shares(kinds, seed, pool);
    for (std::uint32_t k = 0; k < kinds.size(); ++k) {
      known.pools.back().following.push_back(
          {shares[k], is_by_all(kinds[k], calibration.rig),
           views_like(kinds[k], calibration, taken, free, seed, pool + k * pool_count)});
    }
  }
  return known;
}

ViewKnowledge for_cameras(const ViewKnowledge& known, const std::vector<int>& cameras) {
  ViewKnowledge result = known;
  for (ViewPool& pool : result.pools) {
    pool.free = part_by_rig(pool.rig, cameras) * pool.free;
    pool.rig = part_of(pool.rig, cameras);
  }
  return result;
}

std::optional<ViewKnowledge> with_views_by_all(const ViewKnowledge& known) {
  ViewKnowledge result = known;
  for (ViewPool& pool : result.pools) {
    std::erase_if(pool.following, [](const PlannedViews& kind) { return !kind.by_all; });
    if (pool.following.empty()) return {};
    pool.following[0].share = 1;
  }
  return result;
}

ViewKnowledge knowledge_of_datasheet(const RigEstimate& datasheet,
                                     const Chessboard& board,
                                     const SimulatedBoardOptions& views,
                                     const std::string& place) {
  ViewKnowledge known;
  known.noise_px = views.pixel_sigma_px;
  known.noise_log_sd = 0.2;
  std::string why = "the covariance gives no rig that cameras could have";
  const Eigen::MatrixXd free = free_directions(datasheet.rig, held_parameters(datasheet));
  for (std::uint32_t draw = 0; known.pools.size() < pool_count && draw < 4 * pool_count; ++draw) {
    try {
      const Rig rig = datasheet.covariance
                          ? RigSampler(datasheet, place).sample(1, views.seed, draw)
                          : datasheet.rig;
      SimulatedBoardOptions options = views;
      options.poses = draw;
      options.frames = views_per_pool;
      const SimulatedBoard seen = simulate_board(rig, board, options);
      const auto equations = reduced_normal_equations(seen.observations, seen.truth, 1);
      known.pools.push_back(
          {rig, free, {}, {{.views = in_directions(equations.frame_information, free)}}, {}});
    } catch (const Error& error) {
      why = error.fault();
    }
  }
  if (known.pools.size() < pool_count / 2) {
    throw Error(place, why, "give another board, distance or datasheet");
  }
  return known;
}

}  // namespace vernier::internal
