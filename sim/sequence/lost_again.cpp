// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/sequence/lost_again.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "calib/statistics/cluster_interval.h"
#include "sim/sequence/sequence_samples.h"
#include "sim/sources/clustered_samples.h"
#include "sim/sources/measured_sources.h"

namespace vernier::sim::internal {
namespace {

constexpr std::array borders_m{
    0.0, 0.25, 0.5, 1.0, 2.0, 4.0, std::numeric_limits<double>::infinity()};
constexpr std::size_t distance_bands = borders_m.size() - 1;

std::size_t band_of(double distance_m) {
  const auto above = std::upper_bound(borders_m.begin(), borders_m.end(), distance_m);
  return std::min<std::size_t>(distance_bands - 1,
                               static_cast<std::size_t>(above - borders_m.begin()) - 1);
}

/// Calls visit(first, other, distance of their views in metres) for every ordered pair of samples
/// of one line.
template <class Visit>
void for_pairs(const std::vector<ExpectedSample>& expected,
               std::span<const SequenceView> views,
               Visit visit) {
  std::map<int, std::vector<const ExpectedSample*>> of_line;
  for (const ExpectedSample& s : expected) of_line[s.line].push_back(&s);
  const auto centre = [&](const ExpectedSample& s) { return views[s.at.view].T_world_camera.t; };
  for (const auto& [line, samples] : of_line) {
    for (const ExpectedSample* first : samples) {
      for (const ExpectedSample* other : samples) {
        if (other != first) visit(*first, *other, (centre(*first) - centre(*other)).norm());
      }
    }
  }
}

constexpr double pair_step_m = 0.1, farthest_m = 2, largest_side_m = 1.5;

/// Pairs of views of one line, by their distance.
struct Pairs {
  std::size_t step = 0;
  double all = 0, first_lost = 0, both_lost = 0;
};

/// y = h + c x.
class WeightedLine {
 public:
  void add(double weight, double x, double y) {
    const Eigen::Vector3d row(1, x, y);
    sums_ += weight * row * row.transpose();
  }
  double slope() const { return centred(1, 2) / centred(1, 1); }
  /// Sum of the squares that are left with this slope and the best constant.
  double squares(double c) const {
    return centred(2, 2) - 2 * c * centred(1, 2) + c * c * centred(1, 1);
  }

 private:
  double centred(int i, int j) const {
    return sums_(i, j) - sums_(0, i) * sums_(0, j) / sums_(0, 0);
  }
  Eigen::Matrix3d sums_ = Eigen::Matrix3d::Zero();
};

struct FittedLosses {
  double correlation = 0, side_m = 0;
};

double share_of_grids(double d_m, double side_m) {
  const double d = d_m / side_m;
  return d < 1 ? 1 - 4 * d / std::numbers::pi + d * d / std::numbers::pi : 0;
}

FittedLosses fitted(const std::vector<Pairs>& samples) {
  std::array<Pairs, static_cast<std::size_t>(farthest_m / pair_step_m + 0.5)> at{};
  Pairs sum;
  for (const Pairs& s : samples) {
    for (Pairs* total : {&at[s.step], &sum}) {
      total->all += s.all;
      total->first_lost += s.first_lost;
      total->both_lost += s.both_lost;
    }
  }
  FittedLosses best;
  const double lost = sum.first_lost / sum.all;
  double least = std::numeric_limits<double>::infinity();
  for (double side_m = 2 * pair_step_m; side_m <= largest_side_m; side_m += pair_step_m) {
    WeightedLine line;
    for (std::size_t i = 0; i < at.size(); ++i) {
      if (!(at[i].first_lost > 0)) continue;
      line.add(at[i].first_lost,
               share_of_grids((static_cast<double>(i) + 0.5) * pair_step_m, side_m),
               (at[i].both_lost / at[i].first_lost - lost) / (1 - lost));
    }
    const double c = std::clamp(line.slope(), 0.0, 1.0), squares = line.squares(c);
    if (squares < least) {
      least = squares;
      best = {c, side_m};
    }
  }
  return best;
}

}  // namespace

LossesAlike losses_alike(const std::vector<ExpectedSample>& expected,
                         std::span<const SequenceView> views,
                         const std::vector<int>& block,
                         const MeasuringOptions& options) {
  std::map<std::pair<int, std::size_t>, Pairs> sums;  // by block and step
  for_pairs(expected, views,
            [&](const ExpectedSample& first, const ExpectedSample& other, double apart_m) {
              if (apart_m >= farthest_m) return;
              const auto step = static_cast<std::size_t>(apart_m / pair_step_m);
              Pairs& pairs = sums[{block[first.at.view], step}];
              pairs.step = step;
              pairs.all += 1;
              pairs.first_lost += first.found ? 0 : 1;
              pairs.both_lost += first.found || other.found ? 0 : 1;
            });
  ClusteredSamples<Pairs> all;
  int lost = 0;
  for (const auto& [key, pairs] : sums) {
    all.add(key.first, pairs);
    lost += static_cast<int>(pairs.first_lost);
  }
  LossesAlike alike;
  alike.correlation.samples = alike.side_m.samples = lost;
  if (all.count() < options.min_samples) return alike;
  const FittedLosses fit = fitted(all.all());
  const auto of_drawn = [&](std::span<const std::size_t> drawn) {
    const FittedLosses of_blocks = fitted(all.taken(drawn));
    return std::vector<double>{of_blocks.correlation, of_blocks.side_m};
  };
  const auto intervals =
      vernier::internal::cluster_intervals(all.clusters(), 2, of_drawn, options.bootstrap);
  alike.correlation = {fit.correlation, intervals[0], lost};
  alike.side_m = {fit.side_m, intervals[1], lost};
  return alike;
}

std::vector<LostAgain> lost_again(const std::vector<ExpectedSample>& expected,
                                  std::span<const SequenceView> views,
                                  const std::vector<int>& block,
                                  const MeasuringOptions& options) {
  std::array<std::map<int, Sums>, distance_bands> sums;
  std::array<int, distance_bands> pairs{};
  for_pairs(expected, views,
            [&](const ExpectedSample& first, const ExpectedSample& other, double apart_m) {
              if (first.found) return;
              const std::size_t band = band_of(apart_m);
              Sums& total = sums[band][block[first.at.view]];
              total.part += other.found ? 0 : 1;
              total.whole += 1;
              ++pairs[band];
            });
  std::vector<LostAgain> all;
  for (std::size_t i = 0; i < distance_bands; ++i) {
    all.push_back({borders_m[i], borders_m[i + 1],
                   measured_ratio(sums[i], pairs[i], options,
                                  [](const Sums& s) { return s.part / s.whole; })});
  }
  return all;
}

}  // namespace vernier::sim::internal
