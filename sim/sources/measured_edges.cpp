// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// psi_e, psi_l and psi_g from segments of both images.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "calib/statistics/quantile.h"
#include "sim/sources/clustered_samples.h"
#include "sim/sources/measured_figures.h"
#include "sim/sources/measured_sources.h"
#include "sim/sources/variance_line.h"
#include "stereo/evaluation/edge_loss.h"
#include "stereo/evaluation/end_difference.h"
#include "stereo/evaluation/pair_samples.h"
#include "stereo/evaluation/segment_shift.h"

namespace vernier::sim::internal {

using namespace stereo::internal;
using namespace vernier::internal;

namespace {

constexpr double cut_deviations = 3;  // of end points; outliers beyond
constexpr double broken_px = 3;  // along the edge: beyond, the end is a different point of the edge

/// Lost fraction of a length, corrected for chance coverage.
double without_chance(const Sums& sums) {
  const double lost = 1 - sums.part / sums.whole, chance = sums.chance / sums.whole;
  return std::min(1.0, lost / std::max(1e-3, 1 - chance));
}

using Losses = std::vector<SegmentLoss> PairSamples::*;

MeasuredValue loss_of(const PairList& pairs,
                      Losses which,
                      double SegmentLoss::*found,
                      bool take_chance_away,
                      const ClusterOf& cluster,
                      const MeasuringOptions& options) {
  std::map<int, Sums> sums;
  int count = 0;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    for (const SegmentLoss& loss : pairs[p].*which) {
      Sums& sum = sums[cluster(pairs[p], static_cast<int>(p), loss.left_px)];
      sum.part += loss.*found;
      sum.whole += loss.shown_px;
      if (take_chance_away) sum.chance += loss.chance_px;
      ++count;
    }
  }
  return measured_ratio(sums, count, options, without_chance);
}

/// A segment's shift without its pair's global displacement.
struct Shift {
  double towards_px, halves_product, by_row, noise;
};

/// Global displacement (b_x, b_y) of a pair and mean shift towards the brighter side, fitted with
/// Huber weights: shift ~ nᵀ b + c.
Eigen::Vector3d displacement_of(const std::vector<SegmentShift>& shifts) {
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  if (shifts.size() < 20) return b;  // too few to separate it from the segments' own shifts
  for (int round = 0; round < 20; ++round) {
    std::vector<double> sizes;
    const auto row = [](const SegmentShift& s) {
      return Eigen::Vector3d(s.normal.x(), s.normal.y(), 1);
    };
    sizes.reserve(shifts.size());
    for (const SegmentShift& s : shifts) sizes.push_back(std::abs(s.shift_px - row(s).dot(b)));
    const double huber = 1.345 * std::max(0.02, 1.4826 * median_or_zero(sizes));
    Eigen::Matrix3d normal = 1e-6 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < shifts.size(); ++i) {
      const double weight = sizes[i] > huber ? huber / sizes[i] : 1;
      normal += weight * row(shifts[i]) * row(shifts[i]).transpose();
      right += weight * shifts[i].shift_px * row(shifts[i]);
    }
    b = normal.ldlt().solve(right);
  }
  return b;
}

ClusteredSamples<Shift> shifts_of(const PairList& pairs, const ClusterOf& cluster) {
  ClusteredSamples<Shift> shifts;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const Eigen::Vector2d b = displacement_of(pairs[p].shifts).head<2>();
    for (const SegmentShift& s : pairs[p].shifts) {
      const double of_pair = s.normal.dot(b);
      const double noise = 4 * s.within_px * s.within_px / s.points;
      shifts.add(cluster(pairs[p], static_cast<int>(p), s.left_px),
                 {s.shift_px - of_pair, (s.halves_px[0] - of_pair) * (s.halves_px[1] - of_pair),
                  s.normal.x() * s.normal.x(), noise});
    }
  }
  return shifts;
}

/// Larger shifts belong to another edge or have another cause.
double beyond_px(const std::vector<Shift>& shifts) {
  std::vector<double> sizes;
  sizes.reserve(shifts.size());
  for (const Shift& s : shifts) sizes.push_back(std::abs(s.towards_px));
  return std::max(0.3, 4 * 1.4826 * median_or_zero(sizes));
}

VarianceLine shift_variance(const std::vector<Shift>& shifts) {
  const double most = beyond_px(shifts);
  std::vector<SquareSample> squares;
  for (const Shift& s : shifts) {
    if (std::abs(s.towards_px) > most) continue;
    squares.push_back({s.halves_product, s.by_row, s.noise});
  }
  return variance_line(squares, 0);
}

/// Difference between the two ends of a segment.
struct Ends {
  double across_px, along_px, by_row;
};

/// Standard deviation of one image's end point in one direction.
VarianceLine end_variance(const std::vector<Ends>& ends, bool across) {
  std::vector<SquareSample> squares;
  for (const Ends& e : ends) {
    const double d = across ? e.across_px : e.along_px;
    squares.push_back({d * d, across ? e.by_row : 1 - e.by_row, 0});
  }
  return variance_line(squares, cut_deviations);
}

double end_sigma_px(const std::vector<Ends>& ends, bool across) {
  return std::sqrt(end_variance(ends, across).own / 4);
}

}  // namespace

MeasuredEdgeLoss measured_edge_loss(const PairList& pairs,
                                    const ClusterOf& cluster,
                                    const MeasuringOptions& options) {
  MeasuredEdgeLoss result;
  result.share =
      loss_of(pairs, &PairSamples::losses, &SegmentLoss::on_segment_px, true, cluster, options);
  result.to_left = loss_of(pairs, &PairSamples::losses_to_left, &SegmentLoss::on_segment_px, true,
                           cluster, options);
  result.on_edges =
      loss_of(pairs, &PairSamples::losses, &SegmentLoss::found_px, false, cluster, options);
  double shown = 0, lost = 0, longest = 0, chance = 0;
  int all = 0, whole = 0, none = 0, gaps = 0;
  for (const PairSamples& pair : pairs) {
    for (const SegmentLoss& loss : pair.losses) {
      const double missing = loss.shown_px - loss.on_segment_px;
      shown += loss.shown_px;
      chance += loss.chance_px;
      lost += missing;
      longest += loss.longest_gap_px;
      ++all;
      whole += loss.on_segment_px <= 0;
      none += loss.gaps == 0;
      if (loss.on_segment_px > 0) gaps += loss.gaps;
    }
  }
  result.chance = shown > 0 ? chance / shown : 0;
  result.whole = static_cast<double>(whole) / std::max(1, all);
  result.none = static_cast<double>(none) / std::max(1, all);
  result.gaps = static_cast<double>(gaps) / std::max(1, all - whole - none);
  result.longest_gap = lost > 0 ? longest / lost : 0;
  return result;
}

MeasuredLateralShift measured_lateral_shift(const PairList& pairs,
                                            const ClusterOf& cluster,
                                            const MeasuringOptions& options) {
  constexpr double of_independent = 13.0 / 6;  // var(right − left) = 2 s² E[U(1/2, 3/2)²]
  const ClusteredSamples<Shift> shifts = shifts_of(pairs, cluster);
  MeasuredLateralShift result;
  const auto relative = [](const std::vector<Shift>& s) {
    return std::sqrt(shift_variance(s).own);
  };
  result.relative_px = measured(shifts, options, relative, true);
  not_below_zero(result.relative_px);
  result.independent_px = result.relative_px;
  for (double* figure : {&result.independent_px.value, &result.independent_px.interval.low,
                         &result.independent_px.interval.high}) {
    *figure /= std::sqrt(of_independent);
  }
  result.towards_px = measured(shifts, options, [](const std::vector<Shift>& all) {
    std::vector<double> towards;
    towards.reserve(all.size());
    for (const Shift& s : all) towards.push_back(s.towards_px);
    return median_or_zero(std::move(towards));
  });
  if (!result.relative_px.known()) return result;
  const std::vector<Shift> all = shifts.all();
  result.truth_px = std::sqrt(shift_variance(all).other);
  const double most = beyond_px(all);
  for (const Shift& s : all) result.beyond += std::abs(s.towards_px) > most;
  result.beyond /= static_cast<double>(all.size());
  return result;
}

MeasuredEndpoints measured_endpoints(const PairList& pairs,
                                     const ClusterOf& cluster,
                                     const MeasuringOptions& options) {
  ClusteredSamples<Ends> kept;
  int broken = 0;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    for (const SegmentEnds& e : pairs[p].ends) {
      if (std::max(std::abs(e.a.along_px), std::abs(e.b.along_px)) > broken_px) {
        ++broken;
        continue;
      }
      kept.add(cluster(pairs[p], static_cast<int>(p), e.left_px),
               {e.b.across_px - e.a.across_px, e.b.along_px - e.a.along_px,
                e.normal.x() * e.normal.x()});
    }
  }
  MeasuredEndpoints result;
  for (const bool across : {true, false}) {
    MeasuredValue& figure = across ? result.across_px : result.along_px;
    const auto sigma = [&](const std::vector<Ends>& ends) { return end_sigma_px(ends, across); };
    figure = measured(kept, options, sigma, true);
    not_below_zero(figure);
  }
  result.broken = static_cast<double>(broken) / std::max(1, broken + kept.count());
  if (!result.across_px.known()) return result;
  const std::vector<Ends> all = kept.all();
  const VarianceLine line = end_variance(all, true);
  for (const Ends& e : all) {
    const double variance = line.own + e.by_row * line.other;
    result.outliers += e.across_px * e.across_px > cut_deviations * cut_deviations * variance;
  }
  result.outliers /= static_cast<double>(all.size());
  return result;
}

}  // namespace vernier::sim::internal
