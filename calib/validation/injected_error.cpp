// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/validation/injected_error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "calib/base/ordered_parallel.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/outliers.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "calib/statistics/bootstrap.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "calib/triangulation.h"
#include "calib/validation/board_lengths.h"

namespace vernier::internal {
namespace {

constexpr std::size_t corners_of_a_board = 4, boards_to_compare = 3;

/// Relative errors of the lengths on one board, and their mean: the error of the board's size.
struct BoardErrors {
  std::vector<double> of_lengths;
  double of_size = 0;
};

/// Nothing if too few corners can be triangulated.
std::optional<BoardErrors> board_errors(const Rig& told,
                                        const std::vector<Eigen::Vector3d>& target_m,
                                        const SeenPair& seen) {
  std::map<int, Eigen::Vector3d> points;
  std::vector<int> ids;
  for (const auto& [id, pixels] : seen) {
    const auto point = triangulate_point(told, pixels);
    if (!point) continue;
    points.emplace(id, *point);
    ids.push_back(id);
  }
  if (ids.size() < corners_of_a_board) return {};
  BoardErrors errors;
  for (const auto& [a, b] : board_edges(target_m, ids)) {
    const double truth = (target_m[a] - target_m[b]).norm();
    errors.of_lengths.push_back((points.at(a) - points.at(b)).norm() / truth - 1);
    errors.of_size += errors.of_lengths.back();
  }
  errors.of_size /= static_cast<double>(errors.of_lengths.size());
  return errors;
}

/// Errors of one board with one told rig, real and simulated, and what the rig changed in its size
/// beside the one that was estimated, on the same pixels.
struct BothErrors {
  BoardErrors real, simulated;
  double change_real = 0, change_simulated = 0;
};

/// Boards as they were seen, and as a calibration predicts them.
class Boards {
 public:
  Boards(const BoardObservations& observations,
         const BoardState& state,
         double pixel_sigma_px,
         std::uint64_t seed)
      : estimated_(state.rig),
        target_m_(observations.target_m),
        predicted_(observations),
        sigma_px_(pixel_sigma_px),
        seed_(seed) {
    const CornerResiduals residuals = corner_residuals(observations, state);
    for (std::size_t v = 0; v < residuals.size(); ++v) {
      std::vector<Eigen::Vector2d>& pixels = predicted_.views[v].pixels_px;
      for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] += residuals[v][i];
    }
    const std::vector<int> frames = frames_of(observations);
    std::vector<SeenPair> seen = seen_pairs(observations, frames);
    for (std::size_t f = 0; f < frames.size(); ++f) {
      if (seen[f].size() < corners_of_a_board) continue;
      frames_.push_back(frames[f]);
      before_.push_back(board_errors(estimated_, target_m_, seen[f]));
      seen_.push_back(std::move(seen[f]));
    }
  }

  std::size_t size() const { return frames_.size(); }

  /// With a told rig, board by board. Nothing if a board cannot be triangulated with it. Each draw
  /// of a rig has noise of its own.
  std::optional<std::vector<BothErrors>> errors(const Rig& told, std::uint32_t draw) const {
    BoardObservations noisy = predicted_;
    for (BoardView& view : noisy.views) {
      RandomStream draws(of_view({.seed = seed_,
                                  .trial = draw,
                                  .source = static_cast<std::uint32_t>(DrawSource::injected_noise)},
                                 view.frame, view.camera));
      for (Eigen::Vector2d& pixel : view.pixels_px) {
        const double du = draws.normal(), dv = draws.normal();
        pixel += sigma_px_ * Eigen::Vector2d(du, dv);
      }
    }
    const std::vector<SeenPair> simulated = seen_pairs(noisy, frames_);
    std::vector<BothErrors> all;
    for (std::size_t b = 0; b < size(); ++b) {
      auto of_real = board_errors(told, target_m_, seen_[b]);
      auto of_simulated = board_errors(told, target_m_, simulated[b]);
      const auto& real_before = before_[b];
      const auto simulated_before = board_errors(estimated_, target_m_, simulated[b]);
      if (!of_real || !of_simulated || !real_before || !simulated_before) return {};
      const double in_reality = of_real->of_size - real_before->of_size;
      const double in_simulation = of_simulated->of_size - simulated_before->of_size;
      all.push_back({std::move(*of_real), std::move(*of_simulated), in_reality, in_simulation});
    }
    return all;
  }

 private:
  const Rig& estimated_;
  const std::vector<Eigen::Vector3d>& target_m_;
  BoardObservations predicted_;
  double sigma_px_;
  std::uint64_t seed_;
  std::vector<int> frames_;
  std::vector<SeenPair> seen_;
  std::vector<std::optional<BoardErrors>> before_;  // real ones, with the rig as estimated
};

/// Sizes of errors, ascending, each with its board: medians of resampled boards without sorting.
class SortedSizes {
 public:
  void add(const BoardErrors& errors, std::size_t board) {
    for (const double error : errors.of_lengths) sizes_.push_back({std::abs(error), board});
  }
  void sort() { std::sort(sizes_.begin(), sizes_.end()); }

  /// Of boards that count so many times each.
  double median(const std::vector<int>& times) const {
    long total = 0;
    for (const auto& [size, board] : sizes_) total += times[board];
    long below = 0;
    for (const auto& [size, board] : sizes_) {
      below += times[board];
      if (2 * below >= total && total > 0) return size;
    }
    return std::numeric_limits<double>::quiet_NaN();
  }

 private:
  std::vector<std::pair<double, std::size_t>> sizes_;
};

/// Sums of the changes of one board's size, real and simulated.
struct ChangeSums {
  double both = 0, simulated2 = 0, real2 = 0;

  ChangeSums& operator+=(const ChangeSums& other) {
    both += other.both;
    simulated2 += other.simulated2;
    real2 += other.real2;
    return *this;
  }
  double slope() const { return both / simulated2; }
  double correlation() const { return both / std::sqrt(simulated2 * real2); }
};

/// All errors of the lengths on boards, over draws.
struct LengthErrors {
  SortedSizes real, simulated;

  void add(const std::vector<BothErrors>& boards) {
    for (std::size_t b = 0; b < boards.size(); ++b) {
      real.add(boards[b].real, b);
      simulated.add(boards[b].simulated, b);
    }
  }
  void sort() {
    real.sort();
    simulated.sort();
  }
};

std::vector<int> times_of(std::span<const std::size_t> boards, std::size_t count) {
  std::vector<int> times(count, 0);
  for (const std::size_t board : boards) ++times[board];
  return times;
}

/// Compares the errors of all draws of a factor.
void compare(const std::vector<std::optional<std::vector<BothErrors>>>& draws,
             std::size_t boards,
             std::uint64_t seed,
             InjectedErrorLevel& level) {
  LengthErrors lengths;
  std::vector<ChangeSums> changes(boards);
  for (const auto& draw : draws) {
    if (!draw) {
      ++level.failed;
      continue;
    }
    ++level.draws;
    lengths.add(*draw);
    for (std::size_t b = 0; b < boards; ++b) {
      const BothErrors& errors = (*draw)[b];
      changes[b] += {errors.change_real * errors.change_simulated,
                     errors.change_simulated * errors.change_simulated,
                     errors.change_real * errors.change_real};
    }
  }
  lengths.sort();
  const std::vector<int> once(boards, 1);
  level.median_real = lengths.real.median(once);
  level.median_simulated = lengths.simulated.median(once);
  const BootstrapOptions bootstrap{.resamples = 1000, .seed = seed};
  level.ratio_95 = bootstrap_interval(
      boards,
      [&](std::span<const std::size_t> chosen) {
        const std::vector<int> times = times_of(chosen, boards);
        return lengths.real.median(times) / lengths.simulated.median(times);
      },
      bootstrap);
  const auto sum = [&](std::span<const std::size_t> chosen) {
    ChangeSums all;
    for (const std::size_t board : chosen) all += changes[board];
    return all;
  };
  ChangeSums all;
  for (const ChangeSums& change : changes) all += change;
  level.slope = all.slope();
  level.correlation = all.correlation();
  level.slope_95 = bootstrap_interval(
      boards, [&](std::span<const std::size_t> chosen) { return sum(chosen).slope(); }, bootstrap);
}

}  // namespace

InjectedErrorResult inject_calibration_error(
    const RigEstimate& estimate,
    const BoardObservations& observations,
    const BoardState& state,
    double pixel_sigma_px,
    const InjectedErrorOptions& options,
    const std::function<void(int done, int total)>& progress) {
  const auto usable = [](double psi_c) { return psi_c > 0 && std::isfinite(psi_c); };
  if (options.draws < 1 || !std::all_of(options.psi_c.begin(), options.psi_c.end(), usable)) {
    throw Error("injected error", "a factor is not above 0, or there are no draws",
                "use factors such as 1, 3, 10 and 30");
  }
  if (observations.size_px.size() < 2) {
    throw Error("injected error", "needs a pair of cameras", "give views of a pair");
  }
  const Boards boards(observations, state, pixel_sigma_px, options.seed);
  if (boards.size() < boards_to_compare) {
    throw Error("injected error", "fewer than three boards were seen by both cameras",
                "give more views");
  }
  const auto draws = static_cast<std::size_t>(options.draws);
  const auto before = boards.errors(state.rig, 0);
  if (!before) {
    throw Error("injected error", "a board cannot be triangulated with the rig as estimated",
                "leave that frame out");
  }
  const RigSampler sampler(estimate, "injected error");
  InjectedErrorResult result;
  result.boards = static_cast<int>(boards.size());
  LengthErrors lengths;
  lengths.add(*before);
  lengths.sort();
  const std::vector<int> once(before->size(), 1);
  result.median_real = lengths.real.median(once);
  result.median_simulated = lengths.simulated.median(once);
  for (const double psi_c : options.psi_c) {
    InjectedErrorLevel level;
    level.psi_c = psi_c;
    std::vector<std::optional<std::vector<BothErrors>>> told(draws);
    for_each_index(draws, options.threads, [&](std::size_t d) {
      const auto draw = static_cast<std::uint32_t>(d);
      try {
        // Draw 0 of the noise is that of the rig as estimated.
        told[d] = boards.errors(sampler.sample(psi_c, options.seed, draw), draw + 1);
      } catch (const Error&) {  // no cameras have such parameters
      }
    });
    compare(told, boards.size(), options.seed, level);
    result.levels.push_back(level);
    if (progress) {
      progress(static_cast<int>(result.levels.size()), static_cast<int>(options.psi_c.size()));
    }
  }
  return result;
}

}  // namespace vernier::internal
