// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/validation/held_out_boards.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/board_observations.h"
#include "calib/calibrate.h"
#include "calib/error.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/noise_of_estimate.h"
#include "calib/rig_estimate.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/shuffled.h"
#include "calib/validation/board_lengths.h"
#include "calib/validation/held_out_board.h"

namespace vernier::internal {
namespace {

/// Sums for one kind of length.
struct Tally {
  struct Stated {
    int inside = 0;
    double z2 = 0, variance = 0;

    void add(double error, double stated) {
      const double squared = error * error / stated;
      inside += squared <= z_95 * z_95;
      z2 += squared;
      variance += stated;
    }
  };
  int n = 0;
  double error2 = 0;
  Stated honest, mvb, components;

  void add(double error, const StatedVariances& stated) {
    ++n;
    error2 += error * error;
    honest.add(error, stated.honest);
    mvb.add(error, stated.mvb);
    components.add(error, stated.components);
  }

  LengthCoverage coverage() const {
    const double m = std::max(n, 1);
    return {n,
            honest.inside / m,
            mvb.inside / m,
            std::sqrt(honest.z2 / m),
            std::sqrt(mvb.z2 / m),
            std::sqrt(error2 / m),
            std::sqrt(honest.variance / m),
            std::sqrt(mvb.variance / m),
            components.inside / m,
            std::sqrt(components.z2 / m),
            std::sqrt(components.variance / m)};
  }
};

/// Nothing for a board with fewer than four corners, or that no pose fits.
std::optional<BoardVariances> variances_of(const RigEstimate& estimate,
                                           const HeldOutBoard& board,
                                           const CornerNoise& noise) {
  if (board.corners() < 4) return {};
  try {
    return BoardVariances(estimate, board, noise);
  } catch (const Error&) {
    return {};
  }
}

/// Adds the boards of one split that its calibration did not see.
class SplitOfBoards {
 public:
  SplitOfBoards(const BoardObservations& observations,
                const std::vector<int>& frames,
                BoardStand stand)
      : observations_(observations), stand_(stand) {
    std::vector<SeenPair> seen = seen_pairs(observations, frames);
    for (std::size_t f = 0; f < frames.size(); ++f) seen_[frames[f]] = std::move(seen[f]);
  }

  void add(const RigEstimate& estimate,
           const std::vector<int>& frames,
           HeldOutBoardsResult& result) {
    const NoiseParts parts{.motion = stand_ == BoardStand::hand_held, .baseline_motion = true};
    const CornerNoiseEstimate noise =
        estimate_corner_noise(estimate, parts, {.field = false, .motion = false});
    result.noise_not_found += !noise.fit.converged;
    ++result.splits;
    for (const int frame : frames) {
      const SeenPair& seen = seen_.at(frame);
      if (seen.size() < 4) {
        ++result.boards_left_out;
        continue;
      }
      add(estimate, HeldOutBoard(observations_, frame, seen, estimate), noise.fit.noise,
          static_cast<int>(seen.size()), result);
    }
  }

  Tally edges, scales;

 private:
  void add(const RigEstimate& estimate,
           const HeldOutBoard& board,
           const CornerNoise& noise,
           int seen,
           HeldOutBoardsResult& result) {
    result.corners_left_out += seen - board.corners();
    const std::optional<BoardVariances> found = variances_of(estimate, board, noise);
    ++(found ? result.boards : result.boards_left_out);
    if (!found) return;
    const BoardVariances& variances = *found;
    for (const MeasuredValue& length : board.lengths()) {
      edges.add(length.value - length.truth, variances.of(length));
    }
    const MeasuredValue scale = board.scale();
    scales.add(scale.value - scale.truth, variances.of(scale));
  }

  const BoardObservations& observations_;
  std::map<int, SeenPair> seen_;  // by frame
  BoardStand stand_;
};

}  // namespace

HeldOutBoardsResult evaluate_held_out_boards(
    const BoardObservations& observations,
    const HeldOutBoardsOptions& options,
    const std::function<void(int done, int total)>& progress) {
  const std::vector<int> frames = frames_of(observations);
  if (observations.size_px.size() < 2 || frames.size() < fewest_frames_to_divide) {
    throw Error("boards left out", "needs a pair of cameras and at least six frames",
                "give more views");
  }
  const auto n = static_cast<int>(frames.size());
  const int training = options.training_frames > 0 ? options.training_frames : n / 2 + 1;
  if (training < 3 || training >= n) {
    throw Error("boards left out",
                std::to_string(training) + " training frames of " + std::to_string(n),
                "give at least 3, and fewer than there are");
  }
  SplitOfBoards boards(observations, frames, options.stand);
  HeldOutBoardsResult result;
  result.training_frames = training;
  for (int split = 0; split < options.splits; ++split) {
    std::vector<int> kept =
        shuffled(frames, {.seed = options.seed,
                          .trial = static_cast<std::uint32_t>(split),
                          .source = static_cast<std::uint32_t>(DrawSource::left_out_boards)});
    kept.resize(static_cast<std::size_t>(training));
    std::sort(kept.begin(), kept.end());
    std::vector<int> others;
    std::set_difference(frames.begin(), frames.end(), kept.begin(), kept.end(),
                        std::back_inserter(others));
    try {
      boards.add(calibrate(at_frames(observations, kept), options.calibration), others, result);
    } catch (const Error&) {
      ++result.failed;  // these frames alone do not determine the rig
    }
    if (progress) progress(split + 1, options.splits);
  }
  if (result.boards == 0) {
    throw Error("boards left out", "no split could be calibrated and evaluated",
                "give more views, or a model with fewer parameters");
  }
  result.edges = boards.edges.coverage();
  result.scale = boards.scales.coverage();
  return result;
}

}  // namespace vernier::internal
