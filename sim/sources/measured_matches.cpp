// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// psi_cd, psi_cm and psi_s from matched corners and lines.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <vector>

#include "calib/statistics/quantile.h"
#include "sim/sources.h"
#include "sim/sources/clustered_samples.h"
#include "sim/sources/measured_figures.h"
#include "sim/sources/measured_sources.h"
#include "stereo/evaluation/corner_repeatability.h"
#include "stereo/evaluation/line_match.h"
#include "stereo/evaluation/pair_samples.h"

namespace vernier::sim::internal {

using namespace stereo::internal;
using namespace vernier::internal;

namespace {

constexpr double wrong_corner_px = 1.5, wrong_line_px = 3;
constexpr int disparity_bins = 4;

/// Mismatches are uniform over a disc or (`line`) over ± a range, and detected if they are more
/// than some pixels off.
struct MismatchModel {
  double seen_from_px = 0, otherwise_px = 0;  ///< reach if too few are detected to estimate it
  bool line = false;

  /// Reach with the same median error as the detected ones; NaN for fewer than `least`.
  double reach_px(const std::vector<double>& wrong_px, int least) const {
    if (static_cast<int>(wrong_px.size()) < least) return std::numeric_limits<double>::quiet_NaN();
    const double middle = median_or_zero(wrong_px);
    return line ? 2 * middle - seen_from_px
                : std::sqrt(2 * middle * middle - seen_from_px * seen_from_px);
  }

  /// Fraction of mismatches that are detected; at least one half.
  double seen(double reach) const {
    const double hidden = std::min(0.5, seen_from_px / (reach == reach ? reach : otherwise_px));
    return 1 - (line ? hidden : hidden * hidden);
  }

  std::vector<double> wrong(const std::vector<double>& errors_px) const {
    std::vector<double> wrong_px;
    for (const double error : errors_px) {
      if (error > seen_from_px) wrong_px.push_back(error);
    }
    return wrong_px;
  }
};

/// Fraction of all matches, including undetected mismatches; the reach is estimated anew in each
/// resample.
MeasuredValue mismatch_share(const ClusteredSamples<double>& errors_px,
                             const MismatchModel& model,
                             const MeasuringOptions& options) {
  MeasuredValue share = measured(errors_px, options, [&](const std::vector<double>& errors) {
    const std::vector<double> wrong = model.wrong(errors);
    const double seen = model.seen(model.reach_px(wrong, options.wrong_for_reach));
    return std::min(
        1.0, static_cast<double>(wrong.size()) / (static_cast<double>(errors.size()) * seen));
  });
  not_below_zero(share);
  widen_to_wilson(share);
  return share;
}

MeasuredValue mismatch_reach(const ClusteredSamples<double>& errors_px,
                             const MismatchModel& model,
                             const MeasuringOptions& options) {
  MeasuredValue reach = measured(errors_px, options, [&](const std::vector<double>& errors) {
    return model.reach_px(model.wrong(errors), options.wrong_for_reach);
  });
  reach.samples = static_cast<int>(model.wrong(errors_px.all()).size());
  not_below_zero(reach);
  return reach;
}

MeasuredValue corner_loss(const PairList& pairs,
                          const ClusterOf& cluster,
                          const MeasuringOptions& options,
                          double& chance) {
  std::map<int, Sums> sums;
  int count = 0;
  double by_chance = 0;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    for (const CornerRepeatability& corner : pairs[p].corners) {
      Sums& sum = sums[cluster(pairs[p], static_cast<int>(p), corner.left_px)];
      sum.part += corner.found ? 0 : 1;
      sum.whole += 1;
      sum.chance += corner.chance;
      by_chance += corner.chance;
      ++count;
    }
  }
  chance = by_chance / std::max(1, count);
  MeasuredValue loss = measured_ratio(sums, count, options, [](const Sums& all) {
    return std::min(1.0, all.part / std::max(1e-3 * all.whole, all.whole - all.chance));
  });
  widen_to_wilson(loss);
  return loss;
}

/// Matched and wrong lines in four quarters of the observed disparities.
std::vector<MismatchByDisparity> by_disparity(const PairList& pairs,
                                              const ClusterOf& cluster,
                                              const MeasuringOptions& options) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const PairSamples& pair : pairs) {
    for (const LineMatch& line : pair.lines) {
      least = std::min(least, line.disparity_px);
      most = std::max(most, line.disparity_px);
    }
  }
  if (!(most > least)) return {};
  const double width = (most - least) / disparity_bins;
  std::map<int, Sums> sums[disparity_bins];
  std::vector<MismatchByDisparity> bins;
  bins.reserve(disparity_bins);
  for (int bin = 0; bin < disparity_bins; ++bin) {
    bins.push_back({least + bin * width, least + (bin + 1) * width, 0, 0, {}});
  }
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    for (const LineMatch& line : pairs[p].lines) {
      if (!line.matched) continue;
      const int bin =
          std::min(disparity_bins - 1, static_cast<int>((line.disparity_px - least) / width));
      const bool wrong = line.error_px > wrong_line_px;
      ++bins[static_cast<std::size_t>(bin)].lines;
      bins[static_cast<std::size_t>(bin)].wrong += wrong;
      Sums& sum = sums[bin][cluster(pairs[p], static_cast<int>(p), line.left_px)];
      sum.part += wrong;
      sum.whole += 1;
    }
  }
  for (int bin = 0; bin < disparity_bins; ++bin) {
    MismatchByDisparity& of = bins[static_cast<std::size_t>(bin)];
    of.share = measured_ratio(sums[bin], of.lines, options,
                              [](const Sums& all) { return all.part / all.whole; });
    widen_to_wilson(of.share);
  }
  return bins;
}

}  // namespace

MeasuredCorners measured_corners(const PairList& pairs,
                                 const ClusterOf& cluster,
                                 const MeasuringOptions& options) {
  MeasuredCorners result;
  result.loss = corner_loss(pairs, cluster, options, result.chance);
  const MismatchModel model{wrong_corner_px, SourceSettings().corner_mismatch_px, false};
  ClusteredSamples<double> errors;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    for (const CornerError& match : pairs[p].corner_matches) {
      errors.add(cluster(pairs[p], static_cast<int>(p), match.left_px), match.error_px);
      result.wrong += match.error_px > wrong_corner_px;
    }
  }
  result.reach_px = mismatch_reach(errors, model, options);
  result.mismatch = mismatch_share(errors, model, options);
  return result;
}

MeasuredStereoMismatch measured_stereo_mismatch(const PairList& pairs,
                                                const ClusterOf& cluster,
                                                const MeasuringOptions& options) {
  MeasuredStereoMismatch result;
  const MismatchModel model{wrong_line_px, SourceSettings().stereo_mismatch_px, true};
  ClusteredSamples<double> errors;
  int shown = 0, unmatched = 0;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    for (const LineMatch& line : pairs[p].lines) {
      shown += !line.occluded;
      unmatched += !line.occluded && !line.matched;
      if (!line.matched) continue;
      errors.add(cluster(pairs[p], static_cast<int>(p), line.left_px), line.error_px);
      const bool wrong = line.error_px > wrong_line_px;
      result.wrong += wrong;
      result.occluded += wrong && line.occluded;
    }
  }
  result.unmatched = static_cast<double>(unmatched) / std::max(1, shown);
  result.reach_px = mismatch_reach(errors, model, options);
  result.share = mismatch_share(errors, model, options);
  result.by_disparity = by_disparity(pairs, cluster, options);
  return result;
}

}  // namespace vernier::sim::internal
