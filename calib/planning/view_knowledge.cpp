// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/decompositions.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/board_target.h"
#include "calib/calibration/cluster_robust_covariance.h"
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
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"

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

/// Poses of the board in the first camera that sees frames of this kind: in these frames, or, of
/// fewer than three, in all that this camera sees.
std::vector<Pose> poses_like(const FrameKind& kind,
                             const std::vector<FrameKind>& kinds,
                             const RigEstimate& calibration) {
  constexpr std::size_t enough = 3;
  const int camera = kind.cameras[0];
  const Pose& T_camera_first = calibration.rig.T_camera_first[static_cast<std::size_t>(camera)];
  std::vector<Pose> T_camera_board;
  for (const FrameKind& other : kinds) {
    const bool is_like =
        kind.frames.size() < enough
            ? std::binary_search(other.cameras.begin(), other.cameras.end(), camera)
            : &other == &kind;
    if (!is_like) continue;
    for (const std::size_t f : other.frames) {
      T_camera_board.push_back(T_camera_first * calibration.evidence->T_first_board[f]);
    }
  }
  return T_camera_board;
}

/// As many of these frames again, drawn with replacement.
std::vector<Eigen::MatrixXd> taken_again(const FrameKind& kind,
                                         const std::vector<Eigen::MatrixXd>& taken,
                                         std::uint64_t seed,
                                         std::uint32_t number) {
  RandomStream draws({.seed = seed,
                      .trial = number,
                      .source = static_cast<std::uint32_t>(DrawSource::planned_views),
                      .frame = 1});
  const auto frames = static_cast<std::uint32_t>(kind.frames.size());
  std::vector<Eigen::MatrixXd> again;
  for (std::uint32_t i = 0; i < frames; ++i)
    again.push_back(taken[kind.frames[draws.below(frames)]]);
  return again;
}

/// Views that could follow those of kind `k`.
PlannedViews views_like(const std::vector<FrameKind>& kinds,
                        std::size_t k,
                        const RigEstimate& calibration,
                        const std::vector<Eigen::MatrixXd>& taken,
                        const Eigen::MatrixXd& free,
                        std::uint64_t seed,
                        std::uint32_t number) {
  const FrameKind& kind = kinds[k];
  PlannedViews planned;
  planned.cameras = kind.cameras;
  planned.by_all = kind.cameras.size() == calibration.rig.cameras.size();
  planned.taken = static_cast<int>(kind.frames.size());
  const CalibrationEvidence& evidence = *calibration.evidence;
  const std::vector<Eigen::Vector3d>& target_m = evidence.observations.target_m;
  try {
    const PosePopulation population =
        redrawn(pose_population(poses_like(kind, kinds, calibration), target_m), seed, number);
    planned.views =
        in_directions(population_views(calibration.rig, target_m, evidence.warp_m, population,
                                       kind.cameras, views_per_pool, seed, number),
                      free);
  } catch (const Error&) {
    planned.drawn = false;  // too few poses, or boards that are cut
    planned.views = taken_again(kind, taken, seed, number);
  }
  return planned;
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

/// `equations` at the noise σφ. Empty if they and the prior determine no rig.
NoiseByScatter noise_by_scatter(ReducedNormalEquations equations,
                                const Eigen::MatrixXd& prior,
                                const Eigen::MatrixXd& free) {
  if (prior.size() > 0) add_prior(equations, prior);
  const Cholesky factor(equations.information);
  if (!factor.is_positive_definite()) return {};
  const ClusterScatter scatter = scatter_of_clusters(equations, factor.inverse());
  return {free * scatter.contributions, std::sqrt(scatter.inflation)};
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
  const ReducedNormalEquations equations =
      restricted(reduced_normal_equations(evidence.observations, state, 1), free);
  const std::vector<Eigen::MatrixXd>& taken = equations.frame_information;
  const std::vector<FrameKind> kinds = frame_kinds(evidence.observations, evidence.frames);
  const Eigen::MatrixXd prior = information_of_priors(calibration, free);
  known.by_scatter = noise_by_scatter(rescaled(equations, known.noise_px), prior, free);
  for (std::uint32_t pool = 0; pool < pool_count; ++pool) {
    known.pools.push_back({calibration.rig, free, taken, {}, prior});
    const std::vector<double> shares = drawn_shares(kinds, seed, pool);
    for (std::uint32_t k = 0; k < kinds.size(); ++k) {
      PlannedViews planned =
          views_like(kinds, k, calibration, taken, free, seed, pool + k * pool_count);
      planned.share = shares[k];
      known.pools.back().following.push_back(std::move(planned));
    }
  }
  return known;
}

int ViewKnowledge::taken_by_all() const {
  if (pools.empty()) return 0;
  int by_all = 0;
  for (const PlannedViews& kind : pools[0].following) by_all += kind.by_all ? kind.taken : 0;
  return by_all;
}

ViewKnowledge for_cameras(const ViewKnowledge& known, const std::vector<int>& cameras) {
  ViewKnowledge result = known;
  Eigen::MatrixXd& contributions = result.by_scatter.contributions;
  if (contributions.size() > 0) {
    contributions = part_by_rig(known.pools[0].rig, cameras) * contributions;
  }
  for (ViewPool& pool : result.pools) {
    pool.free = part_by_rig(pool.rig, cameras) * pool.free;
    pool.rig = part_of(pool.rig, cameras);
    for (PlannedViews& kind : pool.following) {
      kind.by_all = std::all_of(cameras.begin(), cameras.end(), [&](int camera) {
        return std::binary_search(kind.cameras.begin(), kind.cameras.end(), camera);
      });
    }
  }
  return result;
}

std::optional<ViewKnowledge> with_views_by_all(const ViewKnowledge& known) {
  constexpr int enough = 3;
  ViewKnowledge result = known;
  for (ViewPool& pool : result.pools) {
    std::erase_if(pool.following, [](const PlannedViews& kind) { return !kind.by_all; });
    double sum = 0;
    bool tells = false;
    for (const PlannedViews& kind : pool.following) {
      sum += kind.share;
      tells = tells || kind.drawn || kind.taken >= enough;
    }
    if (!tells || !(sum > 0)) return {};
    for (PlannedViews& kind : pool.following) kind.share /= sum;
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
      PlannedViews planned;
      planned.views = in_directions(equations.frame_information, free);
      known.pools.push_back({rig, free, {}, {std::move(planned)}, {}});
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
