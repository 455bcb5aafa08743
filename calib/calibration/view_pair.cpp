// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/view_pair.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <utility>

#include "calib/base/decompositions.h"
#include "calib/board/board_pose.h"
#include "calib/board_observations.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/solver/initial_rig.h"
#include "calib/solver/normal_equations.h"

namespace vernier::internal {
namespace {

constexpr double sound_times_alone = 4;
constexpr double gross_share = 0.015;  // of the image's longer side

/// The half turn of the target about its centre, as a pose and as a permutation of corners; empty
/// if the corners do not coincide.
std::vector<int> half_turn_of(const std::vector<Eigen::Vector3d>& target_m, Pose& turn) {
  Eigen::Vector3d low = target_m.front(), high = low;
  for (const Eigen::Vector3d& X : target_m) {
    low = low.cwiseMin(X);
    high = high.cwiseMax(X);
  }
  turn.R = Eigen::Vector3d(-1, -1, 1).asDiagonal();
  turn.t = {low.x() + high.x(), low.y() + high.y(), 0};
  const double near = 1e-3 * (high - low).head<2>().norm();
  std::vector<int> taken;
  for (const Eigen::Vector3d& X : target_m) {
    const Eigen::Vector3d turned = turn * X;
    const auto at = std::find_if(target_m.begin(), target_m.end(), [&](const auto& other) {
      return (other - turned).template head<2>().norm() < near;
    });
    if (at == target_m.end()) return {};
    taken.push_back(static_cast<int>(at - target_m.begin()));
  }
  return taken;
}

std::vector<BoardView> views_of_camera(const BoardObservations& observations, int camera) {
  std::vector<BoardView> views;
  for (const BoardView& view : observations.views) {
    if (view.camera == camera) views.push_back(view);
  }
  return views;
}

}  // namespace

PairConsensus::PairConsensus(
    const BoardObservations& observations, const Rig& rig, int first, int second, int shift)
    : observations_(observations), cameras_{rig.cameras[first], rig.cameras[second]} {
  half_turn_ = half_turn_of(observations.target_m, T_board_turned_);
  const std::vector<int> frames = frames_of(observations);
  std::map<int, int> position;
  for (const int frame : frames) position.emplace(frame, static_cast<int>(position.size()));
  const std::vector<BoardView> seconds = views_of_camera(observations, second);
  for (const BoardView& view : views_of_camera(observations, first)) {
    const auto partner = std::find_if(seconds.begin(), seconds.end(), [&](const BoardView& other) {
      return position[other.frame] == position[view.frame] + shift;
    });
    if (partner == seconds.end()) continue;
    ViewPair pair{view, *partner, {}, {}, 0};
    pair.first.camera = 0;
    pair.second.camera = 1;
    for (BoardView* side : {&pair.first, &pair.second}) {
      BoardView alone = *side;
      alone.camera = 0;
      const Rig one{{cameras_[side->camera]}, {Pose{}}};
      const BoardPoseFit fit =
          fit_board_pose_both_ways(observations.target_m, alone, one,
                                   board_pose(observations.target_m, alone, one.cameras[0]), 6);
      (side->camera == 0 ? pair.T_first_board : pair.T_second_board) = fit.T_first_board;
      pair.alone_px = std::max(pair.alone_px, fit.rms_px);
    }
    pairs_.push_back(std::move(pair));
  }
}

ViewPair PairConsensus::read(const ViewPair& pair, PairReading reading) const {
  ViewPair result = pair;
  if (reading == PairReading::turned) {
    for (int& id : result.second.ids) id = half_turn_[id];
    result.T_second_board = pair.T_second_board * T_board_turned_;
  } else if (reading == PairReading::exchanged) {
    std::swap(result.first, result.second);
    std::swap(result.T_first_board, result.T_second_board);
    result.first.camera = 0;
    result.second.camera = 1;
  }
  return result;
}

BoardPoseFit PairConsensus::together(std::size_t index, PairReading reading, const Rig& rig) const {
  return together(read(pairs_[index], reading), rig);
}

BoardPoseFit PairConsensus::together(const ViewPair& pair, const Rig& rig) const {
  const std::array views{pair.first, pair.second};
  const Pose T_first_second = rig.T_camera_first[1].inverse();
  const auto& target_m = observations_.target_m;
  BoardPoseFit best{{}, std::numeric_limits<double>::infinity()};
  const auto consider = [&](const Pose& first, const Pose& second) {
    for (const Pose& start : {first, T_first_second * second}) {
      const BoardPoseFit fit = fit_board_pose(target_m, views, rig, start, 15);
      if (fit.rms_px < best.rms_px) best = fit;
    }
  };
  consider(pair.T_first_board, pair.T_second_board);
  if (fits(pair, best.rms_px)) return best;
  // noise may have decided on which side of the line of sight the board is tilted
  consider(mirrored_board_pose(target_m, pair.first, pair.T_first_board),
           mirrored_board_pose(target_m, pair.second, pair.T_second_board));
  return best;
}

double PairConsensus::together_px(std::size_t pair, PairReading reading, const Rig& rig) const {
  return together(pair, reading, rig).rms_px;
}

double PairConsensus::crossed_px(std::size_t first, std::size_t second, const Rig& rig) const {
  ViewPair pair = pairs_[first];
  pair.second = pairs_[second].second;
  pair.T_second_board = pairs_[second].T_second_board;
  return together(pair, rig).rms_px;
}

double PairConsensus::longest_px() const {
  return std::max(cameras_[0].size_px.maxCoeff(), cameras_[1].size_px.maxCoeff());
}

bool PairConsensus::fits(std::size_t pair, double together_px) const {
  return fits(pairs_[pair], together_px);
}

bool PairConsensus::fits(const ViewPair& pair, double together_px) const {
  return together_px <= std::max(sound_share * longest_px(), sound_times_alone * pair.alone_px);
}

bool PairConsensus::is_gross_misfit(double together_px) const {
  return together_px > gross_share * longest_px();
}

PairConsensus::Half PairConsensus::best_subset(PairReading reading, const Rig& rig) const {
  std::vector<std::pair<double, std::size_t>> order;
  std::vector<BoardPoseFit> fits;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    fits.push_back(together(i, reading, rig));
    order.emplace_back(fits.back().rms_px, i);
  }
  std::sort(order.begin(), order.end());
  order.resize((order.size() + 1) / 2);
  Half half{{{cameras_[0].size_px, cameras_[1].size_px}, observations_.target_m, {}},
            {rig, {}, {}, {0, 0}},
            0};
  for (const auto& [rms_px, i] : order) {
    const ViewPair pair = read(pairs_[i], reading);
    half.state.frames.push_back(static_cast<int>(half.state.frames.size()));
    half.state.T_first_board.push_back(fits[i].T_first_board);
    half.sum_px2 += rms_px * rms_px;
    for (BoardView view : {pair.first, pair.second}) {
      view.frame = half.state.frames.back();
      half.observations.views.push_back(std::move(view));
    }
  }
  return half;
}

std::optional<Rig> PairConsensus::improved(const Half& half, const std::vector<int>& free) {
  try {
    const ReducedNormalEquations equations =
        reduced_normal_equations(half.observations, half.state, 1);
    const Eigen::MatrixXd S = equations.information(free, free);
    const Eigen::VectorXd score = equations.scores.rowwise().sum();
    Eigen::VectorXd delta = Eigen::VectorXd::Zero(score.size());
    delta(free) = -solve_symmetric(S, Eigen::VectorXd(score(free)));
    if (delta.allFinite()) return retract(half.state.rig, delta);
  } catch (const Error&) {  // under a wrong reading, a board pose may be undetermined
  }
  return std::nullopt;
}

Rig PairConsensus::agreed_rig(PairReading reading) const {
  std::vector<Pose> candidates;
  for (const ViewPair& pair : pairs_) {
    const ViewPair seen = read(pair, reading);
    candidates.push_back(seen.T_second_board * seen.T_first_board.inverse());
  }
  Rig rig{cameras_, {Pose{}, consensus_pose(candidates)}};
  // Gauss–Newton on the better half of the frames, with their board poses eliminated: both focal
  // lengths (poorly determined by single images) and the pose between the cameras.
  Half half = best_subset(reading, rig);
  std::vector<int> free{0, intrinsics_index(rig, 1)};
  for (int i = 0; i < 6; ++i) free.push_back(pose_index(rig, 1) + i);
  for (int step = 0; step < 4 && std::isfinite(half.sum_px2); ++step) {
    const std::optional<Rig> moved = improved(half, free);
    if (!moved) break;
    Half next = best_subset(reading, *moved);
    if (!(next.sum_px2 < half.sum_px2)) break;
    rig = *moved;
    half = std::move(next);
  }
  return rig;
}

}  // namespace vernier::internal
